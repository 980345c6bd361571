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
export function basis({ pace }: Estimate): string {
  if (!pace) return "unknown until a first run of this kind has been measured here";
  const judges = `judged by ${pace.runs} earlier ${pace.runs === 1 ? "run" : "runs"}`;
  const [low, high] = [rough(pace.low), rough(pace.high)];
  const wide = pace.high > WIDE * pace.low && low !== high;
  const range = wide ? `; at their paces ${low} to ${high}` : "";
  return `on ${pace.device}, ${judges}${range}`;
}

/** What it will wait for. */
export function wait({ queue }: Estimate): string {
  const { waiting, workers, free } = queue;
  if (workers === 0) return "No worker is running: it will wait until one is.";
  if (waiting > 0) return `${waiting} queued ${waiting === 1 ? "run goes" : "runs go"} before it.`;
  return free > 0 ? "A worker is free: it starts at once." : "It starts when a worker is free.";
}
