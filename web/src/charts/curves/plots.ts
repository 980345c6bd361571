/** What is plotted of a run over its generations. */

import { type Column, type Curves, DIVERGED } from "../../store/curves";
import { number, percent } from "../../ui/format";
import { text } from "./text";

export interface Series {
  name: string;
  /** A variable of the style sheet. */
  colour: string;
  y: Column;
  /** Measured now and then: dots rather than a line. */
  dots?: boolean;
  /** Its own places along the axis, where it has such. */
  x?: Column;
  dash?: number[];
  /** What was measured, behind its smooth line. */
  faint?: boolean;
  /** Of another run. */
  other?: boolean;
  /** Nothing but the edge of a band. */
  edge?: boolean;
}

/** What lies between two of the series, by their places. */
export interface Band {
  high: number;
  low: number;
  colour: string;
}

export interface Plot {
  title: string;
  write: (value: number | null) => string;
  series: Series[];
  bands?: readonly Band[];
}

const again = (curves: Curves, name: string): Series[] => {
  const y = curves.summary[name];
  return y ? [{ name: text.reevaluated, colour: "--series-3", y, dots: true }] : [];
};

/** How good the archive is; beside it, what is left when its elites are evaluated again. */
export function scoresOf(curves: Curves): Plot[] {
  const { qd_score, coverage, best } = curves;
  const score = { name: text.asFound, colour: "--curve-1", y: qd_score };
  const share = { name: text.asFound, colour: "--curve-2", y: coverage };
  return [
    { title: text.qdScore, write: number, series: [score, ...again(curves, "corrected_qd_score")] },
    { title: text.coverage, write: percent, series: [share, ...again(curves, "corrected_coverage")] },
    {
      title: text.bestFitness,
      write: number,
      series: [{ name: "best", colour: "--curve-3", y: best }],
    },
  ];
}

/** What the search is doing: its emitters' success, its luck, its time. */
export function workOf(curves: Curves): Plot[] {
  const plots: Plot[] = [
    { title: text.inserted, write: number, series: ofEmitters(curves, ": inserted") },
    { title: text.improved, write: number, series: ofEmitters(curves, ": improved") },
    {
      title: text.hitRate,
      write: percent,
      series: one(curves, "hit_rate", "--series-3", true),
    },
    {
      title: text.deviceSeconds,
      write: number,
      series: one(withoutFirst(curves), "device_seconds", "--curve-2", false),
    },
    { title: text.diverged, write: number, series: divergedSoFar(curves) },
  ];
  return plots.filter(({ series }) => series.length > 0);
}

/** Why an evaluation does not count, in words; the engine's own names are the keys. */
export const REASONS: Record<string, string> = {
  "non-finite": text.nonFinite,
  supersonic: text.supersonic,
};

/** How many evaluations diverged for each reason that was told, most first. */
export function divergedBy({ summary }: Curves): [reason: string, count: number][] {
  return Object.entries(summary)
    .filter(([name]) => name.startsWith(DIVERGED))
    .map(([name, column]): [string, number] => [
      name.slice(DIVERGED.length),
      column.reduce<number>((sum, value) => sum + (value ?? 0), 0),
    ])
    .sort((a, b) => b[1] - a[1]);
}

function divergedSoFar(curves: Curves): Series[] {
  return divergedBy(curves).map(([reason], i) => {
    let sum = 0;
    const y = curves.summary[DIVERGED + reason]!.map((value) => (sum += value ?? 0));
    return { name: reason, colour: `--series-${3 + (i % 3)}`, y };
  });
}

function ofEmitters({ summary }: Curves, ending: string): Series[] {
  const names = Object.keys(summary).filter((name) => name.endsWith(ending));
  return names.map((name, i) => ({
    name: name.slice(0, -ending.length),
    colour: `--series-${1 + (i % 5)}`,
    y: summary[name]!,
  }));
}

function one({ summary }: Curves, name: string, colour: string, dots: boolean): Series[] {
  const y = summary[name];
  return y ? [{ name, colour, y, dots }] : [];
}

/** The first generation has the compiling in it, beside which the others would be nothing. */
function withoutFirst(curves: Curves): Curves {
  const later = (column: Column) => column.map((value, i) => (curves.generation[i]! > 1 ? value : null));
  const columns = Object.entries(curves.summary).map(([name, column]) => [name, later(column)]);
  return { ...curves, summary: Object.fromEntries(columns) };
}

/** What a run had come to at a place: its newest value until then; null after its end. */
export function valueAt(x: readonly number[], y: Column, i: number): number | null {
  const last = y.findLastIndex((value) => value !== null);
  if (i > last || x.length === 0) return null;
  return y.slice(0, i + 1).findLast((value) => value !== null) ?? null;
}

/** The newest value that there is. */
export function newest(column: Column): number | null {
  return column.findLast((value) => value !== null) ?? null;
}
