/** The plots of a run over its generations. */

import type { Column, Curves } from "../../store/curves";
import { type Kind, nameOf, valuesOf } from "../../store/figureNames";
import { number, percent } from "../../ui/format";
import { text } from "./text";

export interface Series {
  name: string;
  /** A sentence on what it counts, shown at its name. */
  about?: string;
  /** A CSS variable. */
  colour: string;
  y: Column;
  /** Dots in place of a line, for rare values. */
  dots?: boolean;
  /** The x values, once the view is known. */
  x?: Column;
  dash?: number[];
  /** Measured values behind a smooth line. */
  faint?: boolean;
  /** A series of another run. */
  other?: boolean;
  /** The edge of a band. */
  edge?: boolean;
}

/** The area between two series, by their indices. */
export interface Band {
  high: number;
  low: number;
  colour: string;
}

export interface Plot {
  title: string;
  format: (value: number | null) => string;
  series: Series[];
  bands?: readonly Band[];
}

const reevaluated = (curves: Curves, name: string): Series[] => {
  const y = curves.summary[name];
  return y ? [{ name: text.reevaluated, colour: "--series-3", y, dots: true }] : [];
};

/** Quality of the archive, as found and after re-evaluation of its elites. */
export function scoresOf(curves: Curves): Plot[] {
  const { qd_score, coverage, best } = curves;
  const score = { name: text.asFound, colour: "--curve-1", y: qd_score };
  const share = { name: text.asFound, colour: "--curve-2", y: coverage };
  return [
    { title: text.qdScore, format: number, series: [score, ...reevaluated(curves, "corrected_qd_score")] },
    { title: text.coverage, format: percent, series: [share, ...reevaluated(curves, "corrected_coverage")] },
    { title: text.bestFitness, format: number, series: [{ name: "best", colour: "--curve-3", y: best }] },
  ];
}

/** Work of the search: insertions by emitter, re-evaluations, time, infeasible evaluations. */
export function workOf(curves: Curves): Plot[] {
  const deviceSeconds = singleSeries(withoutFirst(curves), "device_seconds", "--curve-2", false);
  const plots: Plot[] = [
    { title: text.inserted, format: number, series: emitterSeries(curves, "emitter.*.inserted") },
    { title: text.improved, format: number, series: emitterSeries(curves, "emitter.*.improved") },
    { title: text.hitRate, format: percent, series: singleSeries(curves, "hit_rate", "--series-3", true) },
    { title: text.deviceSeconds, format: number, series: deviceSeconds },
    { title: text.infeasible, format: number, series: infeasibleSoFar(curves) },
  ];
  return plots.filter(({ series }) => series.length > 0);
}

/** Descriptions of the engine's reasons why an evaluation is infeasible. */
export const REASONS: Record<string, string> = {
  "non-finite": text.nonFinite,
  supersonic: text.supersonic,
  limits: text.limits,
  compressible: text.compressible,
  impulse: text.impulse,
  crossing: text.crossing,
};

/** Infeasible evaluations by reason, most frequent first. */
export function infeasibleBy({ summary }: Curves): [reason: string, count: number][] {
  return valuesOf("infeasible.*", summary)
    .map(([reason, column]): [string, number] => [
      reason,
      column.reduce<number>((sum, value) => sum + (value ?? 0), 0),
    ])
    .sort((a, b) => b[1] - a[1]);
}

function infeasibleSoFar(curves: Curves): Series[] {
  return infeasibleBy(curves).map(([reason], i) => {
    let sum = 0;
    const y = curves.summary[nameOf("infeasible.*", reason)]!.map((value) => (sum += value ?? 0));
    return { name: reason, about: REASONS[reason], colour: `--series-${3 + (i % 3)}`, y };
  });
}

function emitterSeries({ summary }: Curves, kind: Kind): Series[] {
  return valuesOf(kind, summary).map(([name, y], i) => ({ name, colour: `--series-${1 + (i % 5)}`, y }));
}

function singleSeries({ summary }: Curves, name: string, colour: string, dots: boolean): Series[] {
  const y = summary[name];
  return y ? [{ name, colour, y, dots }] : [];
}

/** The first generation includes compilation, which would dwarf all others. */
function withoutFirst(curves: Curves): Curves {
  const later = (column: Column) => column.map((value, i) => (curves.generation[i]! > 1 ? value : null));
  const columns = Object.entries(curves.summary).map(([name, column]) => [name, later(column)]);
  return { ...curves, summary: Object.fromEntries(columns) };
}

/** The newest value up to an index; null after the last value. */
export function valueAt(y: Column, i: number): number | null {
  if (i > y.findLastIndex((value) => value !== null)) return null;
  return y.slice(0, i + 1).findLast((value) => value !== null) ?? null;
}

export function newest(column: Column): number | null {
  return column.findLast((value) => value !== null) ?? null;
}
