/** The creature next to a point, and the relatives to which the arrow keys lead. */

import { type Phylogeny, NONE, parentsOf } from "../decode/phylogeny";
import type { Size } from "../ui/canvas";
import type { TreeLayout } from "./layout";
import type { Place, Scales, View } from "./view";

/** Pixels around a point in which a creature is found. */
const REACH = 14;

export function nearest(
  { time }: Phylogeny,
  { byRow, start, totalRows, size: descendants }: TreeLayout,
  [x, y]: Place,
  view: View,
  scales: Scales,
  size: Size,
  at: number,
): number {
  const row = view.row + (y - size.height / 2) / scales.y;
  const moment = view.time + (x - size.width / 2) / scales.x;
  const [rows, times] = [REACH / scales.y, REACH / scales.x];
  let [best, bestDistance] = [NONE, 1];
  const last = Math.min(totalRows - 1, Math.floor(row + rows));
  for (let r = Math.max(0, Math.ceil(row - rows)); r <= last; r++) {
    for (let k = firstFrom(time, byRow, start[r]!, start[r + 1]!, moment - times); k < start[r + 1]!; k++) {
      const i = byRow[k]!;
      if (time[i]! > moment + times || time[i]! > at) break;
      const distance = Math.hypot((time[i]! - moment) / times, (r - row) / rows);
      // Of several equally near creatures, people mean the one with the most descendants.
      const better = distance < bestDistance - 1e-9 || descendants[i]! > 4 * (descendants[best] ?? Infinity);
      if (distance <= 1 && (best === NONE || better)) [best, bestDistance] = [i, distance];
    }
  }
  return best;
}

/** The first place of a row, between two places, whose creature is not before a time. */
function firstFrom(time: Int32Array, byRow: Int32Array, low: number, high: number, moment: number): number {
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time[byRow[middle]!]! < moment) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** A creature and its first parents, up to the first ancestor. */
export function lineOf({ parent }: TreeLayout, creature: number): number[] {
  const line = [];
  for (let i = creature; i !== NONE; i = parent[i]!) line.push(i);
  return line;
}

/** Links of a line to second parents: child and parent. */
export function otherParents(
  tree: Phylogeny,
  { row }: TreeLayout,
  line: readonly number[],
): [number, number][] {
  return line.flatMap((child) =>
    parentsOf(tree, child)
      .slice(1)
      .filter((parent) => row[parent] !== NONE)
      .map((parent): [number, number] => [child, parent]),
  );
}

/** The creature to which an arrow key leads; itself at an end. Right leads along its own row. */
export function relativeAt(layout: TreeLayout, { time }: Phylogeny, creature: number, key: string): number {
  const { parent, row, byRow, start, totalRows, children } = layout;
  if (key === "ArrowLeft") return parent[creature] === NONE ? creature : parent[creature]!;
  const own = row[creature]!;
  if (key === "ArrowRight") {
    if (children[creature] === 0) return creature;
    return byRow[byRow.indexOf(creature, start[own]!) + 1]!;
  }
  const beside = own + (key === "ArrowUp" ? -1 : 1);
  if (beside < 0 || beside >= totalRows) return creature;
  const from = firstFrom(time, byRow, start[beside]!, start[beside + 1]!, time[creature]!);
  return byRow[Math.min(from, start[beside + 1]! - 1)]!;
}
