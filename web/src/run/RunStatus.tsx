/** The small parts that say how a run is doing. */

import type { Run } from "../api/types";
import { DASH, duration } from "../ui/format";
import "./run.css";

export const STATES = ["queued", "running", "paused", "finished", "failed", "cancelled"] as const;

const REQUESTED = { paused: "pausing", cancelled: "cancelling" };

export function StatusBadge({ run }: { run: Run }) {
  const text = run.requested_state ? REQUESTED[run.requested_state] : run.status;
  return <span class={`badge ${run.status}`}>{text}</span>;
}

export function RunProgress({ run }: { run: Run }) {
  const share = Math.round(1000 * run.progress) / 10;
  return (
    <div
      class={`progress ${run.status}`}
      role="progressbar"
      aria-label="Progress"
      aria-valuenow={share}
      aria-valuemin={0}
      aria-valuemax={100}
    >
      <div style={{ width: `${share}%` }} />
    </div>
  );
}

/** Generations after which a rate is worth telling: the first ones compile. */
const MIN_GENERATIONS = 3;

/** How long a run will take, or what it took, and which of both. */
export function timeOf(run: Run): { label: string; text: string } {
  if (run.status === "running") {
    const left = run.generation < MIN_GENERATIONS ? null : run.eta_seconds;
    return { label: "Time left", text: duration(left) };
  }
  if (!run.started_at || !run.finished_at) return { label: "Time", text: DASH };
  const seconds = (Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000;
  return { label: "Took", text: duration(seconds) };
}

interface CommandHandlers {
  pause: (run: Run) => void;
  resume: (run: Run) => void;
  cancel: (run: Run) => void;
}

/** Only what the run's state allows. */
export function CommandButtons({ run, on, name }: { run: Run; on: CommandHandlers; name: string }) {
  const alive = ["queued", "running", "paused"].includes(run.status);
  if (!alive || run.requested_state === "cancelled") return null;
  return (
    <span class="actions">
      {run.status === "paused" && (
        <button onClick={() => on.resume(run)} aria-label={`Resume ${name}`}>
          Resume
        </button>
      )}
      {run.status !== "paused" && run.requested_state !== "paused" && (
        <button onClick={() => on.pause(run)} aria-label={`Pause ${name}`}>
          Pause
        </button>
      )}
      <button class="danger" onClick={() => on.cancel(run)} aria-label={`Cancel ${name}`}>
        Cancel
      </button>
    </span>
  );
}
