/** What a run will cost, in words. */

import type { Estimate } from "../api/types";

/** A time as one says it of what is not known well. */
export function rough(seconds: number): string {
  if (seconds < 10) return "10 s";
  if (seconds < 90) return `${5 * Math.round(seconds / 5)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  if (seconds < 36 * 3600) return `${Math.round((10 * seconds) / 3600) / 10} h`;
  return seconds < 365 * 86400 ? `${Math.round(seconds / 86400)} days` : "more than a year";
}

/** How long, in short; null where nothing is known. */
export function about({ seconds }: Pick<Estimate, "seconds">): string | null {
  if (seconds === null) return null;
  return seconds < 10 ? "a few seconds" : `about ${rough(seconds)}`;
}

/** From how much the fastest and the slowest judge may differ before it is worth telling. */
const WIDE = 1.5;

/** What the time rests on. */
export function basis({ speed }: Estimate): string {
  if (!speed) return "unknown until a first run of this kind has been measured here";
  const judges = `judged by ${speed.runs} earlier ${speed.runs === 1 ? "run" : "runs"}`;
  const [low, high] = [rough(speed.low), rough(speed.high)];
  const wide = speed.high > WIDE * speed.low && low !== high;
  const range = wide ? `; at their paces ${low} to ${high}` : "";
  return `on ${speed.device}, ${judges}${range}`;
}

/** What it will wait for. */
export function wait({ queue }: Estimate): string {
  const { runs_ahead, workers, idle_workers } = queue;
  if (workers === 0) return "No worker is running: it will wait until one is.";
  if (runs_ahead > 0) return `${runs_ahead} queued ${runs_ahead === 1 ? "run goes" : "runs go"} before it.`;
  return idle_workers > 0 ? "A worker is free: it starts at once." : "It starts when a worker is free.";
}
