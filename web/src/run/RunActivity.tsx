/** What a run is doing where its figures do not say it yet. */

import type { Run } from "../api/types";
import { duration } from "../ui/format";
import "../replay/replay.css";

/** A sentence, or null where generations tell enough. */
export function activityOf(run: Run): string | null {
  if (run.status === "queued") return run.waiting_reason ?? "It waits for a worker that is free.";
  if (run.status !== "running" || run.generation > 0) return null;
  const device = run.device?.toLowerCase() ?? "";
  if (!run.device) return "A worker has begun; it is getting ready.";
  return device.includes("cpu")
    ? "It is compiling and computing its first generation, which takes most of a minute on a CPU."
    : "It is compiling and computing its first generation, which may take half a minute.";
}

/** How long it has been at it, or has waited since it was queued last. */
export function elapsedOf({ status, started_at, queued_at }: Run, now: number): string | null {
  const since = status === "queued" ? queued_at : started_at;
  return since && duration(Math.max(0, Math.floor((now - Date.parse(since)) / 1000)));
}

export function RunActivity({ run, now }: { run: Run; now: number }) {
  const text = activityOf(run);
  const elapsed = elapsedOf(run, now);
  if (!text) return null;
  return (
    <p class="activity">
      <span class="ripple small-ripple" aria-hidden="true" />
      <span role="status">{text}</span>
      {elapsed && (
        <span class="quiet">
          {run.status === "queued" ? "Waiting" : "Running"} for {elapsed}.
        </span>
      )}
      {run.status === "queued" && <a href="/workers">See the workers.</a>}
    </p>
  );
}
