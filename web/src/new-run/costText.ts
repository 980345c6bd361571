/** Texts of the estimated cost. */

import type { Estimate } from "../api/types";
import { text } from "./text";

/** A rounded duration. */
export function rough(seconds: number): string {
  if (seconds < 10) return "10 s";
  if (seconds < 90) return `${5 * Math.round(seconds / 5)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  if (seconds < 36 * 3600) return `${Math.round((10 * seconds) / 3600) / 10} h`;
  return seconds < 365 * 86400 ? text.days(Math.round(seconds / 86400)) : text.overAYear;
}

/** The estimated time in short; null if unknown. */
export function about({ seconds }: Pick<Estimate, "seconds">): string | null {
  if (seconds === null) return null;
  return seconds < 10 ? text.fewSeconds : text.about(rough(seconds));
}

/** The range is shown if the slowest and the fastest earlier run differ by this factor. */
const WIDE = 1.5;

/** The basis of the estimated time. */
export function basis({ speed }: Estimate): string {
  if (!speed) return text.noPace;
  const [low, high] = [rough(speed.low), rough(speed.high)];
  const wide = speed.high > WIDE * speed.low && low !== high;
  const range = wide ? text.paceRange(low, high) : "";
  return text.basis(speed.device, text.basedOn(speed.runs), range);
}

/** What the run will wait for. */
export function wait({ queue }: Estimate): string {
  const { runs_ahead, workers, idle_workers } = queue;
  if (workers === 0) return text.noWorker;
  if (runs_ahead > 0) return text.queued(runs_ahead);
  return idle_workers > 0 ? text.workerFree : text.workerBusy;
}
