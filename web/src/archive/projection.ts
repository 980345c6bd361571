/** Project an archive onto two axes; a bin shows the best of its elites. */

import type { Axis } from "../api/types";
import type { Elite, Elites } from "../store/elites";
import { positionOf } from "../charts/plot/scale";
import { type MapAxis, scaleOf } from "./axes";
import { type Layout, type Shape, binFrom, gridLayout } from "./layout";

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
  elites: Elites;
}

/** The tile of a bin, with the elite of one of its cells instead of the best. */
export function tileWith(
  { tiles, bins, elites }: Projection,
  bin: number,
  cell: number | null,
): Tile | undefined {
  const tile = tiles.get(bin);
  if (!tile || cell === null || bins.get(cell) !== bin) return tile;
  return { ...tile, cell, elite: elites.get(cell)! };
}

/** The elites in a bin with their cells, the best first. */
export function elitesIn({ bins, elites }: Projection, bin: number): (readonly [number, Elite])[] {
  const cells = [...bins].filter(([, other]) => other === bin).map(([cell]) => cell);
  const found = cells.map((cell) => [cell, elites.get(cell)!] as const);
  return found.sort(([a, one], [b, other]) => other.fitness - one.fitness || a - b);
}

/** A range of bins of an axis that the map does not show. */
export interface Slice {
  axis: MapAxis;
  from: number;
  to: number;
}

/** `voronoi` is the layout of a CVT's cells; null if the map shows even bins. */
export function project(
  elites: Elites,
  [x, y]: readonly [MapAxis, MapAxis],
  slices: readonly Slice[] = [],
  voronoi: Layout | null = null,
): Projection {
  const shape: Shape = [x.bins, y.bins];
  const tiles = new Map<number, Tile>();
  const bins = new Map<number, number>();
  for (const [cell, elite] of elites) {
    if (!slices.every((slice) => passes(slice, cell, elite))) continue;
    const [i, j] = [binOfElite(x, cell, elite), binOfElite(y, cell, elite)];
    const bin = voronoi ? cell : i === null || j === null ? null : binFrom({ i, j }, shape);
    if (bin === null) continue;
    bins.set(cell, bin);
    const shown = tiles.get(bin);
    if (!shown) tiles.set(bin, { cell, elite, hidden: 0 });
    else if (elite.fitness > shown.elite.fitness) {
      tiles.set(bin, { cell, elite, hidden: shown.hidden + 1 });
    } else shown.hidden += 1;
  }
  return { layout: voronoi ?? gridLayout(shape), tiles, bins, elites };
}

function passes({ axis, from, to }: Slice, cell: number, elite: Elite): boolean {
  const bin = binOfElite(axis, cell, elite);
  return bin !== null && bin >= from && bin <= to;
}

function binOfElite(axis: MapAxis, cell: number, elite: Elite): number | null {
  if (axis.binOfCell) return axis.binOfCell(cell);
  const value = axis.valueOf(elite);
  return value === null ? null : binOfValue(axis, value);
}

/** The bin of a value; values beyond an end count in the last bin. */
export function binOfValue(axis: Axis, value: number): number {
  const share = positionOf(scaleOf(axis), Math.max(value, axis.low));
  return Math.min(axis.bins - 1, Math.floor(axis.bins * share + 1e-9));
}
