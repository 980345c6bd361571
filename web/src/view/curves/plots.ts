/** What is plotted of a run over its generations. */

import type { Column, Curves } from "../../live/curves";
import { number, percent } from "../format";

export interface Series {
  name: string;
  /** A variable of the style sheet. */
  colour: string;
  y: Column;
  /** Measured now and then: dots rather than a line. */
  dots?: boolean;
}

export interface Plot {
  title: string;
  write: (value: number | null) => string;
  series: Series[];
}

const again = (curves: Curves, name: string): Series[] => {
  const y = curves.summary[name];
  return y ? [{ name: "evaluated again", colour: "--series-3", y, dots: true }] : [];
};

/** How good the archive is; beside it, what is left when its elites are evaluated again. */
export function scoresOf(curves: Curves): Plot[] {
  const { qd_score, coverage, best } = curves;
  const score = { name: "as found", colour: "--curve-1", y: qd_score };
  const share = { name: "as found", colour: "--curve-2", y: coverage };
  return [
    { title: "QD score", write: number, series: [score, ...again(curves, "corrected_qd_score")] },
    { title: "Coverage", write: percent, series: [share, ...again(curves, "corrected_coverage")] },
    {
      title: "Best fitness",
      write: number,
      series: [{ name: "best", colour: "--curve-3", y: best }],
    },
  ];
}

/** What the search is doing: its emitters' success, its luck, its time. */
export function workOf(curves: Curves): Plot[] {
  const plots: Plot[] = [
    { title: "Into empty cells", write: number, series: ofEmitters(curves, ": inserted") },
    { title: "Better than before", write: number, series: ofEmitters(curves, ": improved") },
    {
      title: "Repeats in their own cell",
      write: percent,
      series: one(curves, "hit_rate", "--series-3", true),
    },
    {
      title: "Device-seconds",
      write: number,
      series: one(withoutFirst(curves), "device_seconds", "--curve-2", false),
    },
  ];
  return plots.filter(({ series }) => series.length > 0);
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
  const later = (column: Column) =>
    column.map((value, i) => (curves.generation[i]! > 1 ? value : null));
  const columns = Object.entries(curves.summary).map(([name, column]) => [name, later(column)]);
  return { ...curves, summary: Object.fromEntries(columns) };
}

/** The newest value that there is. */
export function newest(column: Column): number | null {
  return column.findLast((value) => value !== null) ?? null;
}
