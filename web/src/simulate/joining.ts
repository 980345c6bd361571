/** Several creatures in one water: the operands of one rollout of all their bodies. */

import type { Items } from "../decode/evaluation";
import type { Swimmer } from "./swimmer";
import { text } from "./text";

/** What a rollout counts, and of which several creatures have the sum. */
const COUNTED = ["nodes", "edges", "joints", "bodies"] as const;
type Counted = (typeof COUNTED)[number];
/** Numbers that bodies must share: the way in which they take their rest shapes. */
const SHARED = ["matched", "laid_out", "soft"];

/** Operands that follow each other, and what their values count, if they are numbers of things. */
const JOINED: Record<string, Counted | null> = {
  positions: null,
  angles: null,
  edges: "nodes",
  joints: "edges",
  member: "bodies",
  piece: "nodes",
  present: null,
  "layout angles": null,
  "layout rest angles": null,
  "colours of edges": null,
  "colours of joints": null,
  stretch: null,
  shear: null,
  bend: null,
};
/** Operands with a block for each creature, and what their rows and columns are. */
const BLOCKS: Record<string, [Counted, Counted]> = {
  turned: ["edges", "joints"],
  placed: ["nodes", "edges"],
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
  for (const [name, [rows, columns]] of Object.entries(BLOCKS)) {
    const blocks = swimmers.map(({ arrays, numbers }) => ({
      values: arrays.get(name)!,
      rows: arrays.get(name)!.length > 0 ? numbers[rows]! : 0,
      columns: numbers[columns]!,
    }));
    arrays.set(name, diagonal(blocks));
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

interface Block {
  values: Items;
  rows: number;
  columns: number;
}

/** The matrix of blocks along its diagonal. */
export function diagonal(blocks: Block[]): Float32Array {
  const total = (side: "rows" | "columns") => blocks.reduce((all, block) => all + block[side], 0);
  const width = total("columns");
  const found = new Float32Array(total("rows") * width);
  let [row, column] = [0, 0];
  for (const { values, rows, columns } of blocks) {
    for (let i = 0; i < rows; i++) {
      found.set(values.subarray(i * columns, (i + 1) * columns), (row + i) * width + column);
    }
    [row, column] = [row + rows, column + columns];
  }
  return found;
}
