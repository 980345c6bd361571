/** A run's history as columns, kept short enough to draw. */

import type { GenerationEvent, Generations } from "../api/types";

export const LONGEST = 4000;
const DRAWN: (keyof Curves)[] = ["generation", "qd_score", "coverage", "best"];

type Column = readonly (number | null)[];

export interface Curves {
  readonly generation: readonly number[];
  readonly qd_score: Column;
  readonly coverage: Column;
  readonly best: Column;
}

export const NO_CURVES: Curves = columns(() => []);

export function appendCurves(curves: Curves, event: GenerationEvent): Curves {
  const last = curves.generation.at(-1);
  if (last !== undefined && event.generation <= last) return curves;
  const keep = curves.generation.length < LONGEST ? () => true : everySecond;
  return columns((name) => [...curves[name].filter(keep), event[name]]);
}

/** A snapshot, and what events told of later generations while it was on its way. */
export function mergeCurves(generations: Generations, known: Curves): Curves {
  const last = generations.generation.at(-1) ?? -1;
  const later = known.generation.map((generation) => generation > last);
  return columns((name) => [
    ...generations[name],
    ...known[name].filter((_, i) => later[i]),
  ]);
}

export function cutCurves(curves: Curves, generation: number): Curves {
  const kept = curves.generation.map((value) => value <= generation);
  return columns((name) => curves[name].filter((_, i) => kept[i]));
}

function everySecond(_: unknown, i: number): boolean {
  return i % 2 === 0;
}

function columns(column: (name: keyof Curves) => Column): Curves {
  return Object.fromEntries(DRAWN.map((name) => [name, column(name)])) as unknown as Curves;
}
