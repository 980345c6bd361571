/** Phylogenies as columns: creatures in the order of their times, parents before children. */

import { hexadecimal, readColumns } from "./columns";

/** The number for no run, no operator, an unknown generation, and an elite that was not lost. */
export const NONE = -1;

export interface Phylogeny {
  count: number;
  /** Runs in the order of their creation; `run` points here. */
  runs: string[];
  operators: string[];
  /** (count, 32): names as bytes. */
  creature: Uint8Array;
  /** (links, 2): rows of a child and of a parent; the first link of a child is its first parent. */
  links: Int32Array;
  run: Int32Array;
  /** The generation of the run. */
  generation: Int32Array;
  /** The generation in which its last cell went to another. */
  lost: Int32Array;
  operator: Int32Array;
  /** Generations since the first ancestor, over all runs. */
  time: Int32Array;
  /** NaN where it is unknown. */
  fitness: Float64Array;
}

const NAME_BYTES = 32;

export function decodePhylogeny(buffer: ArrayBuffer): Phylogeny {
  const { document: header, columns } = readColumns<Record<string, unknown>>(buffer);
  const arrays = Object.fromEntries(columns.map(({ name, values }) => [name, values]));
  const { runs, operators } = header as unknown as Pick<Phylogeny, "runs" | "operators">;
  return { runs, operators, count: arrays.time!.length, ...arrays } as unknown as Phylogeny;
}

export const nameAt = ({ creature }: Phylogeny, i: number) =>
  hexadecimal(creature.subarray(i * NAME_BYTES, (i + 1) * NAME_BYTES));

/** True for an elite that still has a cell of its run. */
export const isElite = ({ lost, run }: Pick<Phylogeny, "lost" | "run">, i: number) =>
  lost[i] === NONE && run[i] !== NONE;

/** The row of a creature; `NONE` if the tree lacks it. */
export function indexOf({ creature, count }: Phylogeny, name: string): number {
  const bytes = Uint8Array.from(name.match(/../g) ?? [], (pair) => parseInt(pair, 16));
  for (let i = 0; i < count; i++) {
    let same = 0;
    while (same < NAME_BYTES && creature[i * NAME_BYTES + same] === bytes[same]) same++;
    if (same === NAME_BYTES) return i;
  }
  return NONE;
}

/** Parents of one creature, first to last. Links are in the order of their children. */
export function parentsOf({ links }: Phylogeny, child: number): number[] {
  let [low, high] = [0, links.length / 2];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (links[2 * middle]! < child) low = middle + 1;
    else high = middle;
  }
  const found = [];
  for (; links[2 * low] === child; low++) found.push(links[2 * low + 1]!);
  return found;
}
