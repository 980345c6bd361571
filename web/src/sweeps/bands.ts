/** A sweep's curves: of each case the median, the quartiles around it, its runs behind. */

import type { CaseSummary, CaseValues, Json, Member, SweepCurves } from "../api/types";
import type { Band, Plot, Series } from "../charts/curves/plots";
import { number, percent, short } from "../ui/format";

type Figure = "qd_score" | "coverage" | "best";
const FIGURES: [figure: Figure, title: string, write: Plot["write"]][] = [
  ["qd_score", "QD score", number],
  ["coverage", "Coverage", percent],
  ["best", "Best fitness", number],
];

export interface ShownCase {
  summary: CaseSummary;
  /** Its place among all cases. */
  place: number;
  name: string;
  colour: string;
  dash: number[] | undefined;
}

/** Figures that none of the runs has are not plotted. */
export function bandsOf(cases: readonly ShownCase[], curves: SweepCurves | null): Plot[] {
  return FIGURES.flatMap(([figure, title, write]) => {
    const series: Series[] = [];
    const bands: Band[] = [];
    for (const shown of cases) {
      series.push(...linesOf(shown, figure, curves));
      bands.push({ high: series.length, low: series.length + 1, colour: shown.colour });
      series.push(...bandOf(shown, figure));
    }
    const told = series.some(({ y }) => y.some((value) => value !== null));
    return told ? [{ title, write, series, bands }] : [];
  });
}

/** Upper edge, lower edge, median. */
function bandOf({ summary, name, colour, dash }: ShownCase, figure: Figure): Series[] {
  const { high, low, median } = summary[figure];
  const common = { colour, x: summary.generation, other: true };
  return [
    { ...common, name: `${name}, upper quartile`, y: high, edge: true },
    { ...common, name: `${name}, lower quartile`, y: low, edge: true },
    { ...common, name, y: median, ...(dash && { dash }) },
  ];
}

function linesOf({ summary, colour }: ShownCase, figure: Figure, curves: SweepCurves | null): Series[] {
  const mine = new Set(summary.members.map(({ run }) => run));
  const lines = curves?.runs.filter(({ run }) => mine.has(run)) ?? [];
  return lines.map((line) => ({
    name: short(line.run),
    colour,
    x: curves!.generation,
    y: line[figure],
    faint: true,
    other: true,
  }));
}

/** What tells a case from the others; fields by their last names where those are clear. */
export function caseName(values: CaseValues): string {
  const paths = Object.keys(values);
  const last = (path: string) => path.split(".").at(-1)!;
  const clear = new Set(paths.map(last)).size === paths.length;
  const parts = paths.map((path) => `${clear ? last(path) : path} ${valueText(values[path]!)}`);
  return parts.join(", ") || "all runs";
}

export function valueText(value: Json): string {
  if (typeof value === "number") return number(value, 6);
  const text = typeof value === "string" ? value : JSON.stringify(value);
  return text.length > 40 ? `${text.slice(0, 39)}…` : text;
}

/** A run among the others of its case. */
export function memberName({ seed, run }: Member): string {
  return seed === null ? short(run) : `seed ${seed}`;
}
