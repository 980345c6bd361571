/** The colours of a map: a measure of the elites, a scale and a palette. */

import type { Archive } from "../api/types";
import { type Scale, positionOf } from "../charts/plot/scale";
import { type Palette, sequential, lut } from "../ui/colours";
import type { Measures } from "../store/elites";
import { FITNESS, type Measure, choicesOf, measureOf } from "./axes";
import type { Tile, Tiles } from "./projection";
import { text } from "./text";

export interface Colouring {
  measure: Measure;
  palette: Palette;
  scale: Scale;
}

export const AGE = "age";

/** All measures that can be coloured, by name. */
export const coloursOf = (archive: Archive): [name: string, title: string][] => [
  [FITNESS, text.fitness],
  [AGE, text.age],
  ...choicesOf(archive).filter(([name]) => name !== FITNESS),
];

/** The measure of that name; age counts back from the generation shown. */
export function colourMeasure(
  name: string,
  archive: Archive,
  measures: Measures,
  generation: number,
): Measure {
  if (name !== AGE) return measureOf(name, archive, measures);
  const valueOf: Measure["valueOf"] = (elite) => generation - elite.generation;
  return { name, title: text.age, unit: "generations", scale: "linear", valueOf };
}

/** The scale ends at the lowest and the highest value. */
export function colouringOf(measure: Measure, palette: Palette, tiles: Tiles): Colouring {
  const log = measure.scale === "log10";
  let [low, high] = [Infinity, -Infinity];
  for (const { elite } of tiles.values()) {
    const value = measure.valueOf(elite);
    if (value === null || (log && value <= 0)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) [low, high] = log ? [1, 10] : [0, 1];
  return { measure, palette, scale: { log, low, high } };
}

/** The position of a tile along the colours, from 0 to 1; null if the value is unknown. */
export function colourPosition({ measure, scale }: Colouring, tile: Tile): number | null {
  const value = measure.valueOf(tile.elite);
  if (value === null || (scale.log && value <= 0)) return null;
  if (scale.low === scale.high) return 0;
  return Math.min(1, Math.max(0, positionOf(scale, value)));
}

const SHADES = 256;
const tables = new Map<Palette, Uint32Array>();

function shadesOf(palette: Palette): Uint32Array {
  const shades = tables.get(palette) ?? lut((t) => sequential(t, palette), SHADES, [0, 1]);
  tables.set(palette, shades);
  return shades;
}

/** A pixel of the image for each bin; `empty` and `unknown` are given as pixels. */
export function binColours(
  tiles: Tiles,
  count: number,
  colouring: Colouring,
  empty: number,
  unknown: number,
): Uint32Array {
  const shades = shadesOf(colouring.palette);
  const colours = new Uint32Array(count).fill(empty);
  for (const [bin, tile] of tiles) {
    const position = colourPosition(colouring, tile);
    colours[bin] = position === null ? unknown : shades[Math.round(position * (SHADES - 1))]!;
  }
  return colours;
}
