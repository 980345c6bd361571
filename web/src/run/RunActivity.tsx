/** The activity of a run before its first generation. */

import type { Run } from "../api/types";
import { useRunRefresh } from "../store/fetch";
import { useTick } from "../store/timing";
import { duration } from "../ui/format";
import { text } from "./text";
import "../replay/replay.css";

export function activityOf(run: Run): string | null {
  if (run.status === "queued") return run.waiting_reason ?? text.waitingForWorker;
  if (run.status !== "running" || run.generation > 0) return null;
  const device = run.device?.toLowerCase() ?? "";
  if (!run.device) return text.preparing;
  return device.includes("cpu") ? text.compilingCpu : text.compiling;
}

/** The time since the run started, or since it was last queued. */
export function elapsedOf({ status, started_at, queued_at }: Run, now: number): string | null {
  const since = status === "queued" ? queued_at : started_at;
  return since && duration(Math.max(0, Math.floor((now - Date.parse(since)) / 1000)));
}

export function RunActivity({ run }: { run: Run }) {
  const activity = activityOf(run);
  useTick(1000, activity !== null);
  const elapsed = elapsedOf(run, Date.now());
  useRunRefresh(run.id, run.status === "queued" || run.status === "running");
  if (!activity) return null;
  return (
    <p class="activity row">
      <span class="ripple small-ripple" aria-hidden="true" />
      <span role="status">{activity}</span>
      {elapsed && <span class="quiet">{text.elapsed(run.status === "queued", elapsed)}</span>}
      {run.status === "queued" && <a href="/workers">{text.showWorkers}</a>}
    </p>
  );
}
