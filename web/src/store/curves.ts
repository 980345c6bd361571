/** The curves of a run as columns, thinned out if they get long, and its sparkline. */

import type { GenerationEvent, Generations, Values } from "../api/types";
import { isCount, isCurve } from "./figureNames";

export const MAX_POINTS = 4000;
const PLOTTED = ["generation", "evaluations", "seconds", "qd_score", "coverage", "best"] as const;

export type Column = readonly (number | null)[];

export interface Curves {
  readonly generation: readonly number[];
  readonly evaluations: Column;
  readonly seconds: Column;
  readonly qd_score: Column;
  readonly coverage: Column;
  readonly best: Column;
  /** Other numbers of generations; null where a generation lacks one. */
  readonly summary: NumberColumns;
}

type NumberColumns = { readonly [name: string]: Column };
type PlottedColumns = Pick<Curves, (typeof PLOTTED)[number]>;

export const NO_CURVES: Curves = { ...columns(() => []), summary: {} };

export function appendCurves(curves: Curves, event: GenerationEvent): Curves {
  const last = curves.generation.at(-1);
  if (last !== undefined && event.generation <= last) return curves;
  const full = curves.generation.length >= MAX_POINTS;
  const thinned = full ? columns((name) => curves[name].filter((_, i) => i % 2 === 0)) : curves;
  const next = columns((name) => [...thinned[name], event[name]]);
  const numbers = mapValues(numbersOf(event.summary), (value): Column => [value]);
  const summary = concatenate(curves.summary, curves.generation.length, numbers, 1);
  return { ...next, summary: full ? thinOut(summary) : summary };
}

/** A snapshot with later events that arrived before it. */
export function mergeCurves(generations: Generations, known: Curves): Curves {
  const last = generations.generation.at(-1) ?? -1;
  const later = known.generation.map((generation) => generation > last);
  const added = filterRows(known, (i) => later[i]!);
  return {
    ...columns((name) => [...generations[name], ...added[name]]),
    summary: concatenate(
      generations.summary,
      generations.generation.length,
      added.summary,
      added.generation.length,
    ),
  };
}

export function cutCurves(curves: Curves, generation: number): Curves {
  return filterRows(curves, (i) => curves.generation[i]! <= generation);
}

function filterRows(curves: Curves, keep: (i: number) => boolean): Curves {
  const filtered = (column: Column) => column.filter((_, i) => keep(i));
  return { ...columns((name) => filtered(curves[name])), summary: mapValues(curves.summary, filtered) };
}

/** Every second value and the last one: the newest value, or the sum of counts, since the one before. */
function thinOut(summary: NumberColumns): NumberColumns {
  const columns = Object.entries(summary).map(([name, column]) => {
    const last = column.length - 1;
    const indices = [...Array.from({ length: Math.ceil(last / 2) }, (_, k) => 2 * k), last];
    const join = isCount(name) ? sumOf : newestOf;
    return [name, indices.map((i, k) => join(column.slice((indices[k - 1] ?? -1) + 1, i + 1)))];
  });
  return Object.fromEntries(columns);
}

const newestOf = (values: Column) => values.findLast((value) => value !== null) ?? null;

const sumOf = (values: Column) =>
  values.reduce((sum, value) => (value === null ? sum : (sum ?? 0) + value), null);

function concatenate(one: NumberColumns, length: number, other: NumberColumns, more: number): NumberColumns {
  const names = [...new Set([...Object.keys(one), ...Object.keys(other)])];
  const none = (count: number): Column => Array.from({ length: count }, () => null);
  const columns = names.map((name) => [
    name,
    [...(one[name] ?? none(length)), ...(other[name] ?? none(more))],
  ]);
  return Object.fromEntries(columns);
}

function numbersOf(values: Values | null): { [name: string]: number } {
  const numbers = Object.entries(values ?? {}).filter(
    ([name, value]) => typeof value === "number" && isCurve(name),
  );
  return Object.fromEntries(numbers) as { [name: string]: number };
}

function mapValues<A, B>(record: { readonly [name: string]: A }, change: (value: A) => B) {
  return Object.fromEntries(Object.entries(record).map(([name, value]) => [name, change(value)]));
}

function columns(column: (name: (typeof PLOTTED)[number]) => Column): PlottedColumns {
  return Object.fromEntries(PLOTTED.map((name) => [name, column(name)])) as unknown as PlottedColumns;
}

const SPARKLINE_POINTS = 32;

/** Evenly spaced points of a sparkline after one more generation. */
export function withPoint(
  values: readonly number[],
  before: number,
  value: number | null,
  generation: number,
): number[] {
  if (value === null) return [...values];
  if (values.length < SPARKLINE_POINTS) return [...values, value];
  const step = (before - 1) / (values.length - 1);
  return Array.from({ length: SPARKLINE_POINTS }, (_, k) => {
    const place = (k * (generation - 1)) / (SPARKLINE_POINTS - 1);
    const i = Math.min(values.length - 1, Math.floor(place / step));
    const [from, to] = [values[i]!, values[i + 1] ?? value];
    const span = i === values.length - 1 ? generation - before : step;
    return from + ((to - from) * (place - i * step)) / span;
  });
}
