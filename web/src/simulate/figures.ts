/** Figures of an evaluation in single precision, in the order in which JAX computes them. */

import type { Goal } from "../decode/evaluation";

export type Figures = Record<string, number>;

const { fround, sqrt } = Math;

/** Measures whose largest value over trials counts. */
const LARGEST = ["limited", "mach", "impulse", "crossing"];
const SPREAD = "trial_spread";

function sum(values: number[]): number {
  return values.reduce((total, value) => fround(total + value), 0);
}

/** XLA multiplies by the reciprocal of a constant. */
const divided = (value: number, by: number) => fround(value * fround(1 / by));

export const mean = (values: number[]) => divided(sum(values), values.length);

/** The standard deviation of a sample. */
export function deviation(values: number[]): number {
  const middle = mean(values);
  const squares = values.map((value) => fround(fround(value - middle) ** 2));
  return fround(sqrt(divided(sum(squares), values.length - 1)));
}

/** The mean of each figure. */
export function means(all: Figures[]): Figures {
  const names = Object.keys(all[0] ?? {});
  return Object.fromEntries(names.map((name) => [name, mean(all.map((one) => one[name]!))]));
}

/** The fitness of measures; null where a plug-in measures it. */
export function fitnessOf(goal: Goal | null, measures: Figures): number | null {
  if (!goal) return null;
  if (goal.measure !== null) return fround(goal.sign * measures[goal.measure]!);
  const moved = fround(fround(goal.displacement) * measures.displacement!);
  const collected = fround(fround(goal.energy) * measures.energy!);
  if (goal.energy === 0) return measures.displacement!;
  return goal.displacement === 0 ? collected : fround(moved + collected);
}

/**
 * The displacement of a body in its last cycle of some steps.
 *
 * `path` holds the places (step, 2) of its centre, and `start` begins with that at the start.
 */
export function lastCycle(path: Float32Array, start: Float32Array, steps: number): Figures {
  const end = path.length - 2;
  const from = end - 2 * steps;
  const moved = (axis: number) => fround(path[end + axis]! - (from < 0 ? start[axis]! : path[from + axis]!));
  return { cycle_x: moved(0), cycle_y: moved(1) };
}

/** Measures and fitness over trials; each has `fitness` among its figures unless it is unknown. */
export function overTrials(trials: Figures[]): Figures {
  if (trials.length === 1) return { ...trials[0], [SPREAD]: 0 };
  const found = means(trials);
  for (const name of LARGEST) found[name] = Math.max(...trials.map((one) => one[name]!));
  if ("fitness" in found) found[SPREAD] = deviation(trials.map(({ fitness }) => fitness!));
  return found;
}
