/** Curves of a sweep: the median and quartiles of each case, in front of its runs. */

import type { CaseSummary, CaseValues, Json, Member, SweepCurves } from "../api/types";
import type { Band, Plot, Series } from "../charts/curves/plots";
import { number, shortId } from "../ui/format";
import { SCORES } from "../run/figures";
import { text } from "./text";

type Score = (typeof SCORES)[0][0];

export interface ShownCase {
  summary: CaseSummary;
  caseIndex: number;
  name: string;
  colour: string;
  dash: number[] | undefined;
}

/** One plot for each score that any run has. */
export function summaryPlotsOf(cases: readonly ShownCase[], curves: SweepCurves | null): Plot[] {
  return SCORES.flatMap(([figure, title, format]) => {
    const series: Series[] = [];
    const bands: Band[] = [];
    for (const shown of cases) {
      series.push(...linesOf(shown, figure, curves));
      bands.push({ high: series.length, low: series.length + 1, colour: shown.colour });
      series.push(...bandOf(shown, figure));
    }
    const known = series.some(({ y }) => y.some((value) => value !== null));
    return known ? [{ title, format, series, bands }] : [];
  });
}

function bandOf({ summary, name, colour, dash }: ShownCase, figure: Score): Series[] {
  const { high, low, median } = summary[figure];
  const common = { colour, x: summary.generation, other: true };
  return [
    { ...common, name: text.upperQuartile(name), y: high, edge: true },
    { ...common, name: text.lowerQuartile(name), y: low, edge: true },
    { ...common, name, y: median, ...(dash && { dash }) },
  ];
}

function linesOf({ summary, colour }: ShownCase, figure: Score, curves: SweepCurves | null): Series[] {
  const mine = new Set(summary.members.map(({ run }) => run));
  const lines = curves?.runs.filter(({ run }) => mine.has(run)) ?? [];
  return lines.map((line) => ({
    name: shortId(line.run),
    colour,
    x: curves!.generation,
    y: line[figure],
    faint: true,
    other: true,
  }));
}

/** The values of a case, with the last part of each path if it is unique. */
export function caseName(values: CaseValues): string {
  const paths = Object.keys(values);
  const last = (path: string) => path.split(".").at(-1)!;
  const clear = new Set(paths.map(last)).size === paths.length;
  const parts = paths.map((path) => `${clear ? last(path) : path} ${gridValueText(values[path]!)}`);
  return parts.join(", ") || text.oneCase;
}

function gridValueText(value: Json): string {
  if (typeof value === "number") return number(value, 6);
  const written = typeof value === "string" ? value : JSON.stringify(value);
  return written.length > 40 ? `${written.slice(0, 39)}…` : written;
}

export const memberName = ({ seed, run }: Member) => (seed === null ? shortId(run) : text.seed(seed));
