/** The evaluation of a creature: develop, simulate and measure it in all its trials. */

import type { EvaluationInputs, Goal, Simulation } from "../decode/evaluation";
import { Kernel } from "./kernel";
import { type Named, simulated } from "./simulation";

export interface Evaluated {
  /** Measures, and `fitness` unless a plug-in measures it. */
  figures: Figures;
  /** Steps of all simulations, and the seconds that they took. */
  steps: number;
  seconds: number;
}

/** Evaluate a creature; `progress` is called after each simulation with the share that is done. */
export function evaluate(
  module: WebAssembly.Module,
  inputs: EvaluationInputs,
  progress: (share: number) => void,
): Evaluated {
  const began = performance.now();
  const total = inputs.trials.flat().length;
  let done = 0;
  const trials = inputs.trials.map((placements) =>
    means(
      placements.map((one) => {
        const found = figuresOf(new Kernel(module), inputs, one);
        progress(++done / total);
        return found;
      }),
      inputs.largest,
    ),
  );
  return {
    figures: overTrials(trials, inputs.largest),
    steps: total * inputs.numbers.rollout.steps!,
    seconds: (performance.now() - began) / 1000,
  };
}

/** The figures of one simulation. */
function figuresOf(kernel: Kernel, inputs: EvaluationInputs, one: Simulation): Figures {
  const { observed, summary } = simulated(kernel, inputs, one);
  const found = (name: string) => kernel.read(summary.get(name)!);
  const whole = kernel.put(inputs.arrays[one.whole]!);
  const [crossed] = kernel.call("cross", inputs.numbers.rollout, (_, name) =>
    name === "whole" ? whole : (summary.get(name) ?? observed.get(name)),
  );
  const values = found("measures");
  const measures = Object.fromEntries(inputs.measures.map((name, k) => [name, values[k]!]));
  const cycle =
    inputs.cycle === null ? {} : lastCycle(routeOf(kernel, inputs, observed), found("places"), inputs.cycle);
  const [crossing] = kernel.read(crossed!);
  return withFitness(inputs, { ...measures, ...one.constant, ...cycle, crossing: crossing! });
}

function withFitness({ goal }: EvaluationInputs, measures: Figures): Figures {
  const fitness = fitnessOf(goal, measures);
  return fitness === null ? measures : { ...measures, fitness };
}

/**
 * Figures of an evaluation from those of its simulations, in single precision and in the order in which JAX
 * computes them. The engine has them in a program of JAX, which no browser runs, and the kernel ends with
 * one simulation. `tests/engine/audit/test_inputs.py` compares them with the engine's, bit by bit.
 */

type Figures = Record<string, number>;

const { fround, sqrt } = Math;

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

/** The mean of each figure; of those that decide whether a creature is feasible, the largest. */
export function means(all: Figures[], largest: string[]): Figures {
  if (all.length === 1) return all[0]!; // JAX takes no mean of one simulation; a sum would turn −0 into 0.
  const names = Object.keys(all[0] ?? {});
  const whole = (name: string) => (largest.includes(name) ? (values: number[]) => Math.max(...values) : mean);
  return Object.fromEntries(names.map((name) => [name, whole(name)(all.map((one) => one[name]!))]));
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

/** The centre (step, 2) of the body after each step from the corner of its box, and the way to that corner. */
export interface Route {
  centre: Float32Array;
  /** From the corner of the box at the start, in cells. */
  cells: Float32Array;
}

function routeOf(kernel: Kernel, { numbers }: EvaluationInputs, observed: Named): Route {
  const { height, width, bodies } = numbers.rollout;
  const [begun, box] = ["boxes", "box"].map((name) => kernel.read(observed.get(name)!));
  const centre = kernel.read(observed.get("centre")!);
  const cells = centre.map((_, i) => {
    const axis = i % 2;
    return (box![2 * bodies! * ((i - axis) / 2) + axis]! - begun![axis]!) * (axis === 0 ? height! : width!);
  });
  return { centre, cells };
}

/**
 * The displacement of a body in its last cycle of some steps; `start` begins with its place at the start.
 */
export function lastCycle({ centre, cells }: Route, start: Float32Array, steps: number): Figures {
  const end = centre.length - 2;
  const from = end - 2 * steps;
  const moved = (axis: number) => {
    const [now, passed] = [centre[end + axis]!, cells[end + axis]!];
    if (from < 0) return fround(fround(now + passed) - start[axis]!);
    const [before, gone] = [centre[from + axis]!, cells[from + axis]!];
    return fround(fround(now - before) + fround(passed - gone));
  };
  return { cycle_x: moved(0), cycle_y: moved(1) };
}

/** Measures and fitness over trials; each has `fitness` among its figures unless it is unknown. */
export function overTrials(trials: Figures[], largest: string[]): Figures {
  if (trials.length === 1) return { ...trials[0], [SPREAD]: 0 };
  const found = means(trials, largest);
  if ("fitness" in found) found[SPREAD] = deviation(trials.map(({ fitness }) => fitness!));
  return found;
}
