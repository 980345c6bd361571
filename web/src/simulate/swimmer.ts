/** Creatures of live water: their bodies, the rest shapes of their last strokes, and all of them in one rollout. */

import type { EvaluationInputs, Items } from "../decode/evaluation";
import { Kernel } from "./kernel";
import { PLANE, simulated } from "./simulation";
import { text } from "./text";

export type Rest = "rest angles" | "rest lengths";
export const REST: Rest[] = ["rest angles", "rest lengths"];
/** Operands of a rollout that hold integers. */
const INTEGERS = new Set([
  "edges",
  "joints",
  "member",
  "piece",
  "present",
  "bends",
  "colours of edges",
  "colours of joints",
  "walls",
]);
/** The state: operands that a rollout changes and returns. */
export const STATE = ["positions", "angles", "boxes", "energy", "collected"];
/** Figures of the window of the last strokes, in the results of a summary. */
const WINDOW = { start: 1, stop: 2, strokes: 3 };

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

/** Positions (node, 2) from the corner of the first body's box; those of each body count from its own. */
export function fromFirstBox(
  positions: Float32Array,
  boxes: ArrayLike<number>,
  member: ArrayLike<number>,
  size: ArrayLike<number>,
): Float32Array {
  return positions.map((at, i) => {
    const axis = i % 2;
    return at + (boxes[2 * member[(i - axis) / 2]! + axis]! - boxes[axis]!) * size[axis]!;
  });
}

/** The positions of a swimmer's nodes in its own water, from the corner of its first body's box. */
export function together({ arrays, numbers }: Swimmer): Float32Array {
  const [boxes, member] = [arrays.get("boxes")!, arrays.get("member")!];
  const positions = arrays.get("positions") as Float32Array;
  return fromFirstBox(positions, boxes, member, [numbers.height!, numbers.width!]);
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

/** Counts of a rollout, of which several creatures have the sum. */
const COUNTED = ["nodes", "edges", "joints", "bodies"] as const;
type Counted = (typeof COUNTED)[number];
/** Numbers that bodies must share: the way in which they take their rest shapes. */
const SHARED = ["matched", "laid_out", "soft"];

/** Operands that follow each other, and what their values count, if they are numbers of things. */
const JOINED: Record<string, Counted | null> = {
  positions: null,
  angles: null,
  boxes: null,
  edges: "nodes",
  joints: "edges",
  member: "bodies",
  piece: "nodes",
  present: null,
  "layout angles": null,
  "layout rest angles": null,
  bends: null,
  "colours of edges": null,
  "colours of joints": null,
  "whole turns": null,
  stretch: null,
  shear: null,
  bend: null,
};
interface Joined {
  numbers: Record<string, number>;
  arrays: Map<string, Items>;
}

/**
 * The numbers and operands of creatures in the water of the first.
 *
 * Throws an error if a body takes its rest shapes in another way than the first.
 */
export function joined(swimmers: Swimmer[]): Joined {
  const [first] = swimmers as [Swimmer, ...Swimmer[]];
  for (const { numbers } of swimmers) {
    if (SHARED.some((name) => numbers[name] !== first.numbers[name])) throw new Error(text.otherBody);
  }
  const sum = (name: Counted, of: Swimmer[]) => of.reduce((all, { numbers }) => all + numbers[name]!, 0);
  const numbers = { ...first.numbers };
  for (const name of COUNTED) numbers[name] = sum(name, swimmers);
  const arrays = new Map(first.arrays);
  for (const [name, counted] of Object.entries(JOINED)) {
    const parts = swimmers.map(({ arrays }, k) => {
      const part = arrays.get(name)!;
      return counted ? part.map((value) => value + sum(counted, swimmers.slice(0, k))) : part;
    });
    arrays.set(name, chained(parts));
  }
  if (first.arrays.get("collected")!.length > 0) {
    arrays.set("collected", new Float32Array(numbers.nodes!));
  }
  return { numbers, arrays };
}

/** Arrays of one kind, one after another. */
function chained(parts: Items[]): Items {
  const length = parts.reduce((all, part) => all + part.length, 0);
  const found = parts[0] instanceof Int32Array ? new Int32Array(length) : new Float32Array(length);
  let at = 0;
  for (const part of parts) {
    found.set(part, at);
    at += part.length;
  }
  return found;
}
