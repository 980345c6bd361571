/** An archive folded onto two axes: of the elites that share a bin, the best is shown. */

import type { Axis } from "../api/types";
import type { Elite, Elites } from "../store/elites";
import type { MapAxis } from "./axes";
import { type Shape, cellOf } from "./geometry";
import { type Layout, gridLayout } from "./layout";

/** What one bin of the map shows. */
export interface Tile {
  cell: number;
  elite: Elite;
  /** How many elites stand in the same bin and are not shown. */
  behind: number;
}

export type Tiles = ReadonlyMap<number, Tile>;

export interface Projection {
  layout: Layout;
  tiles: Tiles;
  /** The bin of each cell that has a place on the map. */
  bins: ReadonlyMap<number, number>;
}

/** What of an axis that the map does not show is let through: its bins from one to another. */
export interface Slice {
  axis: MapAxis;
  from: number;
  to: number;
}

/** Where `cells` is given, the map shows the archive's own cells, as that lays them out. */
export function project(
  elites: Elites,
  [x, y]: readonly [MapAxis, MapAxis],
  slices: readonly Slice[] = [],
  cells: Layout | null = null,
): Projection {
  const shape: Shape = [x.bins, y.bins];
  const tiles = new Map<number, Tile>();
  const bins = new Map<number, number>();
  for (const [cell, elite] of elites) {
    if (!slices.every((slice) => passes(slice, cell, elite))) continue;
    const bin = cells ? cell : binOfBoth(x, y, cell, elite, shape);
    if (bin === null) continue;
    bins.set(cell, bin);
    const there = tiles.get(bin);
    if (!there) tiles.set(bin, { cell, elite, behind: 0 });
    else if (elite.fitness > there.elite.fitness) {
      tiles.set(bin, { cell, elite, behind: there.behind + 1 });
    } else there.behind += 1;
  }
  return { layout: cells ?? gridLayout(shape), tiles, bins };
}

function passes({ axis, from, to }: Slice, cell: number, elite: Elite): boolean {
  const bin = binOn(axis, cell, elite);
  return bin !== null && bin >= from && bin <= to;
}

function binOfBoth(x: MapAxis, y: MapAxis, cell: number, elite: Elite, shape: Shape) {
  const [i, j] = [binOn(x, cell, elite), binOn(y, cell, elite)];
  return i === null || j === null ? null : cellOf({ i, j }, shape);
}

function binOn(axis: MapAxis, cell: number, elite: Elite): number | null {
  if (axis.binOf) return axis.binOf(cell);
  const value = axis.valueOf(elite);
  return value === null ? null : binOf(axis, value);
}

/** The bin of a value; what is beyond an end counts in the bin there. */
export function binOf({ low, high, bins, scale }: Axis, value: number): number {
  const place = scale === "log10" ? Math.log10(Math.max(value, low)) : value;
  const [from, to] = scale === "log10" ? [Math.log10(low), Math.log10(high)] : [low, high];
  const bin = Math.floor((bins * (place - from)) / (to - from) + 1e-9);
  return Math.min(bins - 1, Math.max(0, bin));
}
