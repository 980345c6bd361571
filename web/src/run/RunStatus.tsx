/** Status, progress, time and commands of a run. */

import type { Run } from "../api/types";
import { DASH, duration } from "../ui/format";
import { text } from "./text";
import "./run.css";

export const STATES = ["queued", "running", "paused", "finished", "failed", "cancelled"] as const;

const REQUESTED = { paused: text.pausing, cancelled: text.cancelling };

export function StatusBadge({ run }: { run: Run }) {
  const status = run.requested_state ? REQUESTED[run.requested_state] : run.status;
  return <span class={`badge ${run.status}`}>{status}</span>;
}

export function RunProgress({ run }: { run: Run }) {
  const share = Math.round(1000 * run.progress) / 10;
  return (
    <div
      class={`progress ${run.status}`}
      role="progressbar"
      aria-label={text.progress}
      aria-valuenow={share}
      aria-valuemin={0}
      aria-valuemax={100}
    >
      <div style={{ width: `${share}%` }} />
    </div>
  );
}

/** Generations before the rate is shown; the first ones include compilation. */
const MIN_GENERATIONS = 3;

/** The time left of a run, or its duration. */
export function timeOf(run: Run): { label: string; text: string } {
  if (run.status === "running") {
    const left = run.generation < MIN_GENERATIONS ? null : run.eta_seconds;
    return { label: text.timeLeft, text: duration(left) };
  }
  if (!run.started_at || !run.finished_at) return { label: text.time, text: DASH };
  const seconds = (Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000;
  return { label: text.took, text: duration(seconds) };
}

interface CommandHandlers {
  pause: (run: Run) => void;
  resume: (run: Run) => void;
  cancel: (run: Run) => void;
}

/** Buttons for the commands that the status allows. */
export function CommandButtons({ run, on, name }: { run: Run; on: CommandHandlers; name: string }) {
  const alive = ["queued", "running", "paused"].includes(run.status);
  if (!alive || run.requested_state === "cancelled") return null;
  return (
    <span class="actions">
      {run.status === "paused" && (
        <button onClick={() => on.resume(run)} aria-label={text.resumeRun(name)}>
          {text.resume}
        </button>
      )}
      {run.status !== "paused" && run.requested_state !== "paused" && (
        <button onClick={() => on.pause(run)} aria-label={text.pauseRun(name)}>
          {text.pause}
        </button>
      )}
      <button class="danger" onClick={() => on.cancel(run)} aria-label={text.cancelRun(name)}>
        {text.cancel}
      </button>
    </span>
  );
}
