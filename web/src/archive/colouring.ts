/** What the colours of a map mean: a measure of the elites, a scale, a palette. */

import type { Archive } from "../api/types";
import { type Palette, pixel, sequential, table } from "../ui/colours";
import { FITNESS, type Measures, type Measure, choicesOf, measureOf } from "./axes";
import type { Tile, Tiles } from "./projection";
import { text } from "./text";

export interface Colouring {
  measure: Measure;
  palette: Palette;
  range: readonly [low: number, high: number];
}

export const AGE = "age";

/** Everything that a map can be coloured by, by name. */
export const coloursOf = (archive: Archive): [name: string, title: string][] => [
  [FITNESS, text.fitness],
  [AGE, text.age],
  ...choicesOf(archive).filter(([name]) => name !== FITNESS),
];

/** The measure of that name; age counts back from the generation that is shown. */
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

/** Ends at the least and the greatest value there is. */
export function colouringOf(measure: Measure, palette: Palette, tiles: Tiles): Colouring {
  let [low, high] = [Infinity, -Infinity];
  for (const { elite } of tiles.values()) {
    const value = scaled(measure, measure.valueOf(elite));
    if (value === null) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return { measure, palette, range: low <= high ? [low, high] : [0, 1] };
}

/** A value on the measure's own scale; null where there is none. */
function scaled({ scale }: Measure, value: number | null): number | null {
  if (value === null || scale === "linear") return value;
  return value > 0 ? Math.log10(value) : null;
}

/** Numbers as people read them for a place along the colours, from 0 to 1. */
export function valueAlong({ measure, range: [low, high] }: Colouring, t: number): number {
  const value = low + (high - low) * t;
  return measure.scale === "log10" ? 10 ** value : value;
}

/** Of a tile along the colours, from 0 to 1, what is beyond an end at it; null where unknown. */
export function placeOf({ measure, range: [low, high] }: Colouring, tile: Tile): number | null {
  const value = scaled(measure, measure.valueOf(tile.elite));
  if (value === null) return null;
  return Math.min(1, Math.max(0, (value - low) / (high - low || 1)));
}

const SHADES = 256;
const tables = new Map<Palette, Uint32Array>();

function shadesOf(palette: Palette): Uint32Array {
  const known = tables.get(palette);
  if (known) return known;
  const shades = table((t) => sequential(t, palette), SHADES, [0, 1]);
  tables.set(palette, shades);
  return shades;
}

/** A pixel of the image for each bin; `empty` where it holds nobody. */
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
    const place = placeOf(colouring, tile);
    colours[bin] = place === null ? unknown : shades[Math.round(place * (SHADES - 1))]!;
  }
  return colours;
}

export const shade = (red: number, green: number, blue: number, alpha: number) =>
  pixel([red, green, blue], alpha);
