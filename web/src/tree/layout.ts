/**
 * Rows of a tree whose time runs from left to right. A creature stands in the row of its child with the
 * most lines of descent, so that a trunk is straight; other children stand above and below it. A subtree
 * has rows of its own: nothing overlaps, and no edge crosses another.
 */

import { type Phylogeny, NONE, isElite } from "../decode/phylogeny";

export interface TreeLayout {
  /** The first parent of each creature. */
  parent: Int32Array;
  /** `NONE` for a creature that is not shown. */
  row: Int32Array;
  /** The first row of each creature and its descendants. */
  low: Int32Array;
  /** Their number of rows, which is that of childless creatures among them. */
  rows: Int32Array;
  /** Their number. */
  size: Int32Array;
  /** The latest time among them. */
  last: Int32Array;
  /** Number of children. */
  children: Int32Array;
  /** Creatures, each before its descendants, from the first row to the last. */
  order: Int32Array;
  /** The place in `order` behind a creature's descendants, by its place there. */
  end: Int32Array;
  /** Creatures by row, and in a row by time; those of a row begin at `start`. */
  byRow: Int32Array;
  start: Int32Array;
  totalRows: number;
}

/** The layout of all creatures, or of those with a 1 in `shown`, whose ancestors must have it too. */
export function layoutOf(tree: Phylogeny, shown?: Uint8Array): TreeLayout {
  const parent = firstParents(tree);
  const { rows, size, last, children } = sums(tree, parent, shown);
  const { begin, list } = childrenByRows(parent, rows, shown);
  const low = new Int32Array(tree.count).fill(NONE);
  const main = new Int32Array(tree.count).fill(NONE);
  const place = (kin: Int32Array, first: number) => {
    const ordered = fromTheMiddle(kin);
    let next = first;
    for (const child of ordered) {
      low[child] = next;
      next += rows[child]!;
    }
    return next;
  };
  const family = (i: number) => list.subarray(begin[i + 1]!, begin[i + 2]);
  const totalRows = place(family(NONE), 0);
  for (let i = 0; i < tree.count; i++) {
    if (low[i] === NONE || children[i] === 0) continue;
    main[i] = family(i)[0]!;
    place(family(i), low[i]!);
  }
  const row = low.slice();
  for (let i = tree.count - 1; i >= 0; i--) if (main[i] !== NONE) row[i] = row[main[i]!]!;
  const { order, end } = preorder(low, size, parent);
  return { parent, row, low, rows, size, last, children, order, end, totalRows, ...listed(row, totalRows) };
}

function firstParents({ links, count }: Phylogeny): Int32Array {
  const parent = new Int32Array(count).fill(NONE);
  for (let i = links.length - 2; i >= 0; i -= 2) parent[links[i]!] = links[i + 1]!;
  return parent;
}

/** Sums over the descendants of each creature; a parent comes before its children. */
function sums({ time, count }: Phylogeny, parent: Int32Array, shown?: Uint8Array) {
  const [rows, size, children] = [new Int32Array(count), new Int32Array(count), new Int32Array(count)];
  const last = time.slice();
  for (let i = count - 1; i >= 0; i--) {
    if (shown && !shown[i]) continue;
    if (children[i] === 0) rows[i] = 1;
    size[i]!++;
    const above = parent[i]!;
    if (above === NONE) continue;
    children[above]!++;
    rows[above]! += rows[i]!;
    size[above]! += size[i]!;
    last[above] = Math.max(last[above]!, last[i]!);
  }
  return { rows, size, last, children };
}

/** Children of each creature, most rows first; those of creature i begin at `begin[i + 1]`, roots at 0. */
function childrenByRows(parent: Int32Array, rows: Int32Array, shown?: Uint8Array) {
  const count = parent.length;
  const all = Int32Array.from({ length: count }, (_, i) => count - 1 - i);
  const kept = shown ? all.filter((i) => shown[i]) : all;
  const most = kept.reduce((known, i) => Math.max(known, rows[i]!), 0);
  const sorted = bucketed(kept, most + 1, (i) => most - rows[i]!).list;
  return bucketed(sorted, count + 1, (i) => parent[i]! + 1);
}

/** Numbers in the order of their keys; equal ones stay in their order. */
function bucketed(numbers: Int32Array, keys: number, keyOf: (i: number) => number) {
  const begin = new Int32Array(keys + 1);
  for (const i of numbers) begin[keyOf(i) + 1]!++;
  for (let key = 0; key < keys; key++) begin[key + 1]! += begin[key]!;
  const next = begin.slice();
  const list = new Int32Array(numbers.length);
  for (const i of numbers) list[next[keyOf(i)]!++] = i;
  return { begin, list };
}

/** The first in the middle, the others in turn above and below it. */
function fromTheMiddle(kin: Int32Array): number[] {
  const [above, below]: [number[], number[]] = [[], []];
  kin.forEach((one, i) => (i % 2 ? above : below).push(one));
  return [...above.reverse(), ...below];
}

function preorder(low: Int32Array, size: Int32Array, parent: Int32Array) {
  const shown = low.reduce((sum, first) => sum + (first === NONE ? 0 : 1), 0);
  const order = new Int32Array(shown);
  const end = new Int32Array(shown);
  // A creature stands behind its parent and the subtrees of its siblings in earlier rows.
  const place = new Int32Array(low.length).fill(NONE);
  const all = Int32Array.from({ length: low.length }, (_, i) => i).filter((i) => low[i] !== NONE);
  const most = all.reduce((known, i) => Math.max(known, low[i]!), 0);
  const next = new Int32Array(low.length + 1);
  const byRow = bucketed(all, most + 1, (i) => low[i]!).list;
  for (const i of byRow) {
    const above = parent[i]!;
    const first = above === NONE ? next[low.length]! : place[above]! + 1 + next[above]!;
    place[i] = first;
    next[above === NONE ? low.length : above]! += size[i]!;
    order[first] = i;
    end[first] = first + size[i]!;
  }
  return { order, end };
}

function listed(row: Int32Array, totalRows: number) {
  const all = Int32Array.from({ length: row.length }, (_, i) => i).filter((i) => row[i] !== NONE);
  const { begin, list } = bucketed(all, totalRows, (i) => row[i]!);
  return { byRow: list, start: begin };
}

/** A 1 for each creature that is an elite now, or whose line leads to one. */
export function surviving(tree: Phylogeny, parent: Int32Array): Uint8Array {
  const found = Uint8Array.from({ length: tree.count }, (_, i) => Number(isElite(tree, i)));
  for (let i = tree.count - 1; i >= 0; i--) if (found[i] && parent[i] !== NONE) found[parent[i]!] = 1;
  return found;
}

/** Lines of creatures with one child each, which one edge can stand for. */
export interface Chains {
  /** 1 for a creature within such a line. */
  within: Uint8Array;
  /** The nearest ancestor that is not within a line. */
  above: Int32Array;
  /** The number of creatures between the two. */
  between: Int32Array;
}

export function chainsOf({ parent, children }: Pick<TreeLayout, "parent" | "children">): Chains {
  const within = Uint8Array.from(parent, (above, i) => Number(above !== NONE && children[i] === 1));
  const above = parent.slice();
  const between = new Int32Array(parent.length);
  for (let i = 0; i < parent.length; i++) {
    const near = parent[i]!;
    if (near === NONE || !within[near]) continue;
    above[i] = above[near]!;
    between[i] = between[near]! + 1;
  }
  return { within, above, between };
}
