/** One simulation of a creature: its development, its rollout and its summary, in a kernel. */

import type { EvaluationInputs, Simulation } from "../decode/evaluation";
import type { Area, Kernel, Results } from "./kernel";

/** Operands of the forces on the water besides those of bodies, and of walls. */
export const FORCES = ["uniform force", "forces across rows", "forces along rows", "walls"];
/** Operands of a summary that are those of its rollout; all others are results. */
const OF_START = ["positions", "angles", "boxes", "edges", "joints", "member", "present", ...FORCES];
export const PLANE = "a plane";
const REST = ["rest angles", "rest lengths"];
const CLOCK = "clock";
/** The number of `commands` of a rollout whose rest shapes are given. */
export const GIVEN = 0;

export type Named = Map<string, Area>;

export interface Simulated {
  /** Operands of the rollout, by name; its planes share one. */
  begin: Named;
  /** Results of the rollout in their order. */
  end: Results;
  /** Operands of the summary, by name. */
  observed: Named;
  /** Results of the summary, by name. */
  summary: Named;
}

/** Develop a creature, simulate and measure it. */
export function simulated(kernel: Kernel, inputs: EvaluationInputs, one: Simulation): Simulated {
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
  const observed = byName(end);
  for (const name of numbers.commands === GIVEN ? [...OF_START, ...REST] : OF_START) {
    observed.set(name, begin.get(name)!);
  }
  observed.set(CLOCK, developed?.get(CLOCK) ?? area(one.clock)).set("scales", area(one.scales));
  const summary = kernel.call("summarise", numbers, (place, name) =>
    name === PLANE ? end[place] : observed.get(name),
  );
  return { begin, end, observed, summary: byName(summary) };
}

const byName = (results: Results): Named => new Map(results.map((result) => [result.name, result]));

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
