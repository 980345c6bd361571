/** The evaluation of a creature: develop, simulate and measure it in all its trials. */

import type { EvaluationInputs, Simulation } from "../decode/evaluation";
import { crossing } from "./crossing";
import { type Figures, fitnessOf, means, overTrials } from "./figures";
import { type Area, Kernel } from "./kernel";

export interface Evaluated {
  /** Measures, and `fitness` unless a plug-in measures it. */
  figures: Figures;
  /** Steps of all simulations, and the seconds that they took. */
  steps: number;
  seconds: number;
}

/** Operands of a summary that are those of its rollout; all others are results. */
const OF_START = ["positions", "angles", "edges", "joints", "present"];
const PLANE = "a plane";
const REST = ["rest angles", "rest lengths"];
const CLOCK = "clock";
/** The number of `commands` of a rollout whose rest shapes are given. */
const GIVEN = 0;

type Named = Map<string, Area>;

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
        const found = simulated(new Kernel(module), inputs, one);
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
function simulated(kernel: Kernel, inputs: EvaluationInputs, one: Simulation): Figures {
  const areas = new Map<number, Area>();
  const area = (place: number) => {
    if (!areas.has(place)) areas.set(place, kernel.put(inputs.arrays[place]!));
    return areas.get(place)!;
  };
  const developed = one.develop.length > 0 ? development(kernel, inputs, one, area) : null;
  const begin: Named = new Map();
  const numbers = inputs.numbers.rollout;
  const end = kernel.call("rollout", numbers, (place, name) => {
    const found = developed?.get(name) ?? area(one.rollout[place]!);
    begin.set(name, found);
    return found;
  });
  const named: Named = new Map(end.map((result) => [result.name, result]));
  for (const name of numbers.commands === GIVEN ? [...OF_START, ...REST] : OF_START) {
    named.set(name, begin.get(name)!);
  }
  named.set(CLOCK, developed?.get(CLOCK) ?? area(one.clock)).set("scales", area(one.scales));
  const summary = kernel.call("summarise", numbers, (place, name) =>
    name === PLANE ? end[place] : named.get(name),
  );
  const found = (name: string) => kernel.read(summary.find((result) => result.name === name)!);
  const crossed = crossing(found("frames"), inputs.arrays[one.whole] as Int32Array, {
    edges: kernel.readIntegers(named.get("edges")!),
    present: kernel.readIntegers(named.get("present")!),
  });
  return withFitness(inputs, {
    ...byName(inputs.measures, found("measures")),
    ...one.constant,
    crossing: crossed,
  });
}

/** The rest shapes that the controller commands, for all copies, and its clock. */
function development(
  kernel: Kernel,
  { numbers, copies }: EvaluationInputs,
  { develop }: Simulation,
  area: (place: number) => Area,
): Named {
  const found = kernel.call("develop", numbers.develop, (place) => area(develop[place]!));
  const steps = numbers.develop.steps!;
  return new Map(
    found.map((result) => [
      result.name,
      copies === 1 || result.name === CLOCK
        ? result
        : kernel.put(repeated(kernel.read(result), steps, copies)),
    ]),
  );
}

/** Rows (step, item) with the items of each row several times, one after another. */
export function repeated(values: Float32Array, steps: number, times: number): Float32Array {
  const items = values.length / steps;
  const found = new Float32Array(values.length * times);
  for (let step = 0; step < steps; step++) {
    const row = values.subarray(step * items, (step + 1) * items);
    for (let copy = 0; copy < times; copy++) found.set(row, (step * times + copy) * items);
  }
  return found;
}

const byName = (names: string[], values: Float32Array): Figures =>
  Object.fromEntries(names.map((name, k) => [name, values[k]!]));

function withFitness({ goal }: EvaluationInputs, measures: Figures): Figures {
  const fitness = fitnessOf(goal, measures);
  return fitness === null ? measures : { ...measures, fitness };
}
