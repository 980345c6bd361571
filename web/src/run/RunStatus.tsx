/** Status, progress, time and commands of a run. */

import type { Run } from "../api/types";
import { cancelWithUndo, sendCommand } from "../store/commands";
import { Progress } from "../ui/Page";
import { DASH, duration } from "../ui/format";
import { text } from "./text";
import "./run.css";

export const STATES = ["queued", "running", "paused", "finished", "failed", "cancelled"] as const;

export function StatusBadge({ run }: { run: Run }) {
  const status = run.requested_state ? text.requested[run.requested_state] : run.status;
  return <span class={`badge ${run.status}`}>{status}</span>;
}

export const RunProgress = ({ run }: { run: Run }) => (
  <Progress label={text.progress} share={run.progress} kind={run.status} />
);

/** Generations before the time left is shown; the first ones include compilation. */
const MIN_GENERATIONS = 3;

export function timeOf(run: Run): { label: string; text: string } {
  if (run.status === "running") {
    const left = run.generation < MIN_GENERATIONS ? null : run.eta_seconds;
    return { label: text.timeLeft, text: duration(left) };
  }
  if (!run.started_at || !run.finished_at) return { label: text.time, text: DASH };
  const seconds = (Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000;
  return { label: text.took, text: duration(seconds) };
}

interface CommandProps {
  run: Run;
  /** Name in notes, and in labels of buttons. */
  title: string;
  name: string;
}

export function CommandButtons({ run, title, name }: CommandProps) {
  const { id, status, requested_state } = run;
  const alive = ["queued", "running", "paused"].includes(status);
  if (!alive || requested_state === "cancelled") return null;
  return (
    <span class="actions">
      {status === "paused" && (
        <button onClick={() => void sendCommand(id, "resume")} aria-label={text.resumeRun(name)}>
          {text.resume}
        </button>
      )}
      {status !== "paused" && requested_state !== "paused" && (
        <button onClick={() => void sendCommand(id, "pause")} aria-label={text.pauseRun(name)}>
          {text.pause}
        </button>
      )}
      <button class="danger" onClick={() => cancelWithUndo(id, title)} aria-label={text.cancelRun(name)}>
        {text.cancel}
      </button>
    </span>
  );
}
