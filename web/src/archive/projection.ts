/** Project an archive onto two axes; a bin shows the best of its elites. */

import type { Axis } from "../api/types";
import type { Elite, Elites } from "../store/elites";
import { positionOf } from "../charts/plot/scale";
import { type MapAxis, scaleOf } from "./axes";
import { type Layout, type Shape, cellOf, gridLayout } from "./layout";

export interface Tile {
  cell: number;
  elite: Elite;
  /** The number of hidden elites in the same bin. */
  hidden: number;
}

export type Tiles = ReadonlyMap<number, Tile>;

export interface Projection {
  layout: Layout;
  tiles: Tiles;
  /** The bin of each cell on the map. */
  bins: ReadonlyMap<number, number>;
}

/** A range of bins of an axis that the map does not show. */
export interface Slice {
  axis: MapAxis;
  from: number;
  to: number;
}

/** `cells` is the layout of the archive's own cells, if the map shows them. */
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
    const [i, j] = [binOn(x, cell, elite), binOn(y, cell, elite)];
    const bin = cells ? cell : i === null || j === null ? null : cellOf({ i, j }, shape);
    if (bin === null) continue;
    bins.set(cell, bin);
    const shown = tiles.get(bin);
    if (!shown) tiles.set(bin, { cell, elite, hidden: 0 });
    else if (elite.fitness > shown.elite.fitness) {
      tiles.set(bin, { cell, elite, hidden: shown.hidden + 1 });
    } else shown.hidden += 1;
  }
  return { layout: cells ?? gridLayout(shape), tiles, bins };
}

function passes({ axis, from, to }: Slice, cell: number, elite: Elite): boolean {
  const bin = binOn(axis, cell, elite);
  return bin !== null && bin >= from && bin <= to;
}

function binOn(axis: MapAxis, cell: number, elite: Elite): number | null {
  if (axis.binOf) return axis.binOf(cell);
  const value = axis.valueOf(elite);
  return value === null ? null : binOf(axis, value);
}

/** The bin of a value; values beyond an end count in the last bin. */
export function binOf(axis: Axis, value: number): number {
  const share = positionOf(scaleOf(axis), Math.max(value, axis.low));
  return Math.min(axis.bins - 1, Math.floor(axis.bins * share + 1e-9));
}
