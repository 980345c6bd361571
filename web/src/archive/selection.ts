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

export interface Box {
  from: Position;
  to: Position;
}

/** The filled bins with their middle in a box, and those under its two corners. */
export function binsWithin({ from, to }: Box, layout: Layout, tiles: Tiles): number[] {
  const [left, right] = [Math.min(from[0], to[0]), Math.max(from[0], to[0])];
  const [top, bottom] = [Math.min(from[1], to[1]), Math.max(from[1], to[1])];
  const ends = [from, to].map((corner) => layout.at(...corner));
  return [...tiles.keys()].filter((bin) => {
    const [x, y] = layout.centre(bin);
    return (left <= x && x <= right && top <= y && y <= bottom) || ends.includes(bin);
  });
}

/** True if a click or a drag adds to the selection. */
export const isAdditive = (event: MouseEvent) => event.shiftKey || event.ctrlKey || event.metaKey;
