/** Status, progress, activity and commands of a run. */

import type { Run } from "../api/types";
import { cancelWithUndo, sendCommand } from "../store/commands";
import { useRunRefresh } from "../store/fetch";
import { useTick } from "../store/polling";
import { Progress } from "../ui/Page";
import { DASH, duration } from "../ui/format";
import { text } from "./text";
import "./run.css";
import "../replay/replay.css";

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
  const active = ["queued", "running", "paused"].includes(status);
  if (!active || requested_state === "cancelled") return null;
  const command = status === "paused" ? "resume" : requested_state === "paused" ? null : "pause";
  return (
    <span class="actions">
      {command && (
        <button onClick={() => void sendCommand(id, command)} aria-label={`${text[command]} ${name}`}>
          {text[command]}
        </button>
      )}
      <button
        class="danger"
        onClick={() => void cancelWithUndo(id, title)}
        aria-label={`${text.cancel} ${name}`}
      >
        {text.cancel}
      </button>
    </span>
  );
}

export function activityOf(run: Run): string | null {
  if (run.status === "queued") return run.waiting_reason ?? text.waitingForWorker;
  if (run.status !== "running" || run.generation > 0) return null;
  return run.device ? text.compiling : text.preparing;
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
