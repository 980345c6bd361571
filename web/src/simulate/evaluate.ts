/** The evaluation of a creature: develop, simulate and measure it in all its trials. */

import type { EvaluationInputs, Simulation } from "../decode/evaluation";
import { crossing } from "./crossing";
import { type Figures, fitnessOf, lastCycle, means, overTrials } from "./figures";
import { Kernel } from "./kernel";
import { simulated } from "./simulation";

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
    ),
  );
  return {
    figures: overTrials(trials),
    steps: total * inputs.numbers.rollout.steps!,
    seconds: (performance.now() - began) / 1000,
  };
}

/** The figures of one simulation. */
function figuresOf(kernel: Kernel, inputs: EvaluationInputs, one: Simulation): Figures {
  const { observed, summary } = simulated(kernel, inputs, one);
  const found = (name: string) => kernel.read(summary.get(name)!);
  const crossed = crossing(found("frames"), inputs.arrays[one.whole] as Int32Array, {
    edges: kernel.readIntegers(observed.get("edges")!),
    present: kernel.readIntegers(observed.get("present")!),
  });
  const values = found("measures");
  const measures = Object.fromEntries(inputs.measures.map((name, k) => [name, values[k]!]));
  const path = () => kernel.read(observed.get("centre")!);
  const cycle = inputs.cycle === null ? {} : lastCycle(path(), found("places"), inputs.cycle);
  return withFitness(inputs, { ...measures, ...one.constant, ...cycle, crossing: crossed });
}

function withFitness({ goal }: EvaluationInputs, measures: Figures): Figures {
  const fitness = fitnessOf(goal, measures);
  return fitness === null ? measures : { ...measures, fitness };
}
