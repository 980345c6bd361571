/** Selecting elites on the map or in the gallery, by bins with all of their elites. */

import type { Projection, Tiles } from "./projection";
import type { Layout, Position } from "./layout";

/** Cells of the archive. */
export type CellSet = ReadonlySet<number>;

export interface Selection {
  selected: CellSet;
  /** Null if selecting is not allowed. */
  onSelect: ((selected: CellSet) => void) | null;
}

const NONE: CellSet = new Set();

/** The cells of all elites in some bins. */
export function cellsIn(bins: Iterable<number>, projection: Pick<Projection, "bins">): CellSet {
  const included = new Set(bins);
  return new Set([...projection.bins].flatMap(([cell, bin]) => (included.has(bin) ? [cell] : [])));
}

/** The bins with selected elites; null without a selection. */
export function binsOf(selected: CellSet, projection: Pick<Projection, "bins">): CellSet | null {
  if (selected.size === 0) return null;
  return new Set([...selected].flatMap((cell) => projection.bins.get(cell) ?? []));
}

export const union = (some: CellSet, others: CellSet): CellSet => new Set([...some, ...others]);

/** Add these cells, or remove them if all of them are selected. */
export function toggle(selected: CellSet, cells: CellSet): CellSet {
  const all = [...cells].every((cell) => selected.has(cell));
  return all ? new Set([...selected].filter((cell) => !cells.has(cell))) : union(selected, cells);
}

/** The selection after a key; null if the key does not change it. */
export function selectByKey(
  { key, shiftKey }: KeyboardEvent,
  selected: CellSet,
  projection: Projection,
  from: number | null,
  next: number | null,
): CellSet | null {
  if (key === "Escape") return selected.size > 0 ? NONE : null;
  if (from === null) return null;
  if (key === " ") return toggle(selected, cellsIn([from], projection));
  if (!shiftKey || next === null) return null;
  return union(selected, cellsIn([from, next], projection));
}

/** The corners of a region that was drawn over the map. */
export type Region = readonly Position[];

/** A way is straight if it stays this close to the line between its ends, as a share of that line. */
const STRAIGHT = 0.15;

/** The region of a drag: the box from end to end of a straight way, else what the way encloses. */
export function regionOf(way: Region): Region {
  const [from, to] = [way[0]!, way.at(-1)!];
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const straight = way.every(([x, y]) => {
    const [px, py] = [x - from[0], y - from[1]];
    const along = dx * px + dy * py;
    const [aside, length] = [Math.abs(dx * py - dy * px), dx * dx + dy * dy];
    return aside <= STRAIGHT * length && along >= -STRAIGHT * length && along <= (1 + STRAIGHT) * length;
  });
  return straight ? [from, [to[0], from[1]], to, [from[0], to[1]]] : way;
}

/** The filled bins with their middle in a region, and those under its corners. */
export function binsWithin(region: Region, layout: Layout, tiles: Tiles): number[] {
  const under = new Set(region.map((corner) => layout.at(...corner)));
  return [...tiles.keys()].filter((bin) => under.has(bin) || encloses(region, layout.centre(bin)));
}

/** True if a ray from a point to the right crosses the border an odd number of times. */
function encloses(region: Region, [x, y]: Position): boolean {
  let inside = false;
  region.forEach(([bx, by], i) => {
    const [ax, ay] = region.at(i - 1)!;
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  });
  return inside;
}

/** True if a click or a drag adds to the selection. */
export const isAdditive = (event: MouseEvent) => event.shiftKey || event.ctrlKey || event.metaKey;
