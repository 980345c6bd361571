/** Creatures that are shown as bodies: as many as have room, the most important ones first. */

import { type Phylogeny, NONE, isElite } from "../decode/phylogeny";
import type { Size } from "../ui/canvas";
import type { TreeLayout } from "./layout";
import type { Scales, View } from "./view";
import { placeOf } from "./view";

/** Sides of a body in pixels, when many are shown and when few are; the most that are shown. */
const [SMALL, LARGE, MOST] = [44, 60, 60];
/** Room around a body, as a share of its side: more of the tree is seen when it is far. */
const [FAR_ROOM, NEAR_ROOM] = [2.5, 1.04];
/** Weights of an elite of today, and of fitness, beside that of descendants. */
const [ALIVE, FIT] = [0.25, 0.75];

/** Creatures by importance: those with many descendants, fit ones, elites of today. */
export function ranked(tree: Phylogeny, layout: TreeLayout, share: (i: number) => number): Int32Array {
  const { size, row } = layout;
  const most = Math.log2(1 + size.reduce((known, one) => Math.max(known, one), 1));
  const score = Float64Array.from({ length: tree.count }, (_, i) => {
    return Math.log2(1 + size[i]!) / most + FIT * share(i) + (isElite(tree, i) ? ALIVE : 0);
  });
  const shown = Int32Array.from({ length: tree.count }, (_, i) => i).filter((i) => row[i] !== NONE);
  return shown.sort((a, b) => score[b]! - score[a]!);
}

export interface Landmark {
  creature: number;
  side: number;
}

/** Landmarks in a window around a view, without overlaps. `first` comes before all others. */
export function landmarksOf(
  ranking: Int32Array,
  { time }: Phylogeny,
  { row }: TreeLayout,
  view: View,
  scales: Scales,
  size: Size,
  at: number,
  first: readonly number[],
): Landmark[] {
  const near = view.zoom;
  const side = SMALL + (LARGE - SMALL) * near;
  const room = side * (FAR_ROOM + (NEAR_ROOM - FAR_ROOM) * near);
  const taken = new Map<string, [number, number][]>();
  const found: Landmark[] = [];
  const consider = (i: number) => {
    if (time[i]! > at) return;
    const [x, y] = placeOf({ time: time[i]!, row: row[i]! }, scales, view, size);
    if (x < 0 || y < 0 || x > size.width || y > size.height) return;
    const [column, line] = [Math.floor(x / room), Math.floor(y / room)];
    for (let k = 0; k < 9; k++) {
      const others = taken.get(`${column + (k % 3) - 1} ${line + Math.floor(k / 3) - 1}`);
      if (others?.some(([ox, oy]) => Math.hypot(ox - x, oy - y) < room)) return;
    }
    const key = `${column} ${line}`;
    taken.set(key, [...(taken.get(key) ?? []), [x, y]]);
    found.push({ creature: i, side });
  };
  first.forEach(consider);
  for (let k = 0; k < ranking.length && found.length < MOST; k++) consider(ranking[k]!);
  return found;
}
