/** A creature of live water: its body, and the rest shapes of its last strokes, which repeat. */

import type { EvaluationInputs, Items } from "../decode/evaluation";
import { Kernel } from "./kernel";
import { PLANE, simulated } from "./simulation";

export type Rest = "rest angles" | "rest lengths";
export const REST: Rest[] = ["rest angles", "rest lengths"];
/** Operands of a rollout that hold integers. */
const INTEGERS = new Set([
  "edges",
  "joints",
  "member",
  "piece",
  "present",
  "colours of edges",
  "colours of joints",
]);
/** What a rollout changes, in its operands and its results. */
export const STATE = ["positions", "angles", "energy", "collected"];
/** Figures of the window of the last strokes, in the results of a summary. */
const WINDOW = { start: 3, stop: 4, strokes: 5 };

export interface Swimmer {
  /** Numbers of its rollout. */
  numbers: Record<string, number>;
  /** Operands of its rollout except planes, with its state at the end of its simulation. */
  arrays: Map<string, Items>;
  /** The water at the end of its simulation. */
  planes: Float32Array[];
  /** Rest shapes (step, item) of its simulation. */
  rest: Record<Rest, Float32Array>;
  /** Steps of its last strokes. */
  window: { start: number; stop: number };
  /** Steps of a stroke; of the whole simulation for a creature without strokes. */
  stroke: number;
  /** The step of its simulation whose rest shape it takes, which may lie between two. */
  step: number;
}

/** Evaluate a creature; it then stands at the end of its simulation. */
export function swimmerOf(module: WebAssembly.Module, inputs: EvaluationInputs): Swimmer {
  const kernel = new Kernel(module); // Its memory is freed with it.
  const { begin, end, observed, summary } = simulated(kernel, inputs, inputs.trials[0]![0]!);
  const arrays = new Map<string, Items>();
  for (const [name, area] of begin) {
    arrays.set(name, INTEGERS.has(name) ? kernel.readIntegers(area) : kernel.read(area));
  }
  for (const area of end) if (STATE.includes(area.name)) arrays.set(area.name, kernel.read(area));
  const shown = kernel.read(summary.get("shown")!);
  const window = { start: shown[WINDOW.start]!, stop: shown[WINDOW.stop]! };
  return {
    numbers: inputs.numbers.rollout,
    arrays,
    planes: end.filter(({ name }) => name === PLANE).map((area) => kernel.read(area)),
    rest: {
      "rest angles": kernel.read(observed.get("rest angles")!),
      "rest lengths": kernel.read(observed.get("rest lengths")!),
    },
    window,
    stroke: (window.stop - window.start) / Math.max(1, shown[WINDOW.strokes]!),
    step: window.start,
  };
}

/** A step of the window of its last strokes. */
export function within({ window: { start, stop } }: Swimmer, step: number): number {
  return step < stop ? step : start + ((step - start) % (stop - start));
}

/** Write the rest shape of a step, between the recorded ones, and return the number of its items. */
export function writeRest(swimmer: Swimmer, name: Rest, step: number, to: Float32Array): number {
  const { rest, numbers } = swimmer;
  const items = rest[name].length / numbers.steps!;
  const at = within(swimmer, step);
  const [before, share] = [Math.floor(at), at % 1];
  const after = within(swimmer, before + 1);
  for (let i = 0; i < items; i++) {
    const value = rest[name][before * items + i]!;
    to[i] = share === 0 ? value : value + share * (rest[name][after * items + i]! - value);
  }
  return items;
}
