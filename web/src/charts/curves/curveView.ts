/** The view of curves: x axis, scale, smoothing, and other runs for comparison. */

import { type Column, type Curves, NO_CURVES } from "../../store/curves";
import type { Plot, Series } from "./plots";

/** Windows of the running mean, in generations; 1 for no smoothing. */
export const WINDOWS = [1, 5, 20, 100] as const;

export const AXES = ["generation", "evaluations", "seconds"] as const;
export type Axis = (typeof AXES)[number];

export interface CurveView {
  over: Axis;
  log: boolean;
  smooth: number;
}

export function curveViewOf(query: URLSearchParams): CurveView {
  const over = AXES.find((name) => name === query.get("over")) ?? "generation";
  const smooth = WINDOWS.find((size) => String(size) === query.get("smooth")) ?? 1;
  return { over, log: query.get("log") === "1", smooth };
}

/** Another run for comparison. */
export interface OtherRun {
  name: string;
  colour: string;
  /** Distinguishes lines if there are more runs than colours. */
  dash?: number[];
  curves: Curves;
}

/** The plots of a run, with the curves of other runs. */
export function arrangePlots(
  plotsOf: (curves: Curves) => Plot[],
  curves: Curves,
  others: readonly OtherRun[],
  view: CurveView,
): Plot[] {
  const compared = others.map((other) => comparisonPlots(plotsOf, other, view));
  return plotsOf(curves).map((plot) => {
    const lines = others.length > 0 ? plot.series.map(inOneColour) : plot.series;
    const main = lines.flatMap((each) => withSmoothLine({ ...each, x: curves[view.over] }, curves, view));
    return { ...plot, series: [...main, ...seriesOfTitle(plot, compared)] };
  });
}

/** The plots of several runs, none of which is the main one. */
export function overlayPlots(
  plotsOf: (curves: Curves) => Plot[],
  runs: readonly OtherRun[],
  view: CurveView,
): Plot[] {
  const plots = runs.map((run) => comparisonPlots(plotsOf, run, view));
  return plotsOf(NO_CURVES).map((plot) => ({ ...plot, series: seriesOfTitle(plot, plots) }));
}

const seriesOfTitle = ({ title }: Plot, plots: Plot[][]) =>
  plots.flatMap((each) => each.find((other) => other.title === title)?.series ?? []);

/** The plots of another run, in its colour and with its own x values. */
function comparisonPlots(plotsOf: (curves: Curves) => Plot[], other: OtherRun, view: CurveView): Plot[] {
  const { name, colour, dash, curves } = other;
  return plotsOf(curves).map((plot) => ({
    ...plot,
    series: plot.series.map((each, k) => ({
      ...inOneColour(each, k),
      name: plot.series.length > 1 ? `${name}: ${each.name}` : name,
      colour,
      ...(dash && { dash }),
      x: curves[view.over],
      other: true,
      y: smoothed(each, curves.generation, view.smooth),
    })),
  }));
}

/** If colours distinguish runs, the lines of a run differ by their dashes. */
function inOneColour(series: Series, k: number): Series {
  return { ...series, colour: "--series-1", ...(k > 0 && { dash: [6, 2 + 2 * k] }) };
}

/** The measured line, faint, and the smoothed one in front of it. */
function withSmoothLine(series: Series, curves: Curves, { smooth }: CurveView): Series[] {
  if (smooth === 1 || series.dots) return [series];
  const mean = smoothed(series, curves.generation, smooth);
  return [
    { ...series, faint: true },
    { ...series, y: mean },
  ];
}

const smoothed = ({ y, dots }: Series, generation: readonly number[], window: number) =>
  dots || window === 1 ? y : runningMean(y, generation, window);

/** The mean of the values in a window of generations that ends at each point. */
export function runningMean(y: Column, generation: readonly number[], window: number): Column {
  let [sum, count, first] = [0, 0, 0];
  return y.map((value, i) => {
    if (value !== null) [sum, count] = [sum + value, count + 1];
    for (; generation[first]! <= generation[i]! - window; first++) {
      const gone = y[first]!;
      if (gone !== null) [sum, count] = [sum - gone, count - 1];
    }
    return value === null || count === 0 ? null : sum / count;
  });
}

/** The places of generations on the x axis; those without a point yet have none. */
export function placesOf(generations: readonly number[], curves: Curves, { over }: CurveView): number[] {
  const places = generations.map((generation) => {
    const i = curves.generation.findIndex((at) => at >= generation);
    return i < 0 ? null : curves[over][i];
  });
  return [...new Set(places.filter((place) => place != null))];
}

type Cell = number | null | undefined;

/** Columns for uPlot: undefined without a value, which a line skips; null if a log scale cannot show it, which breaks the line. */
export function tableOf(series: readonly Series[], log: boolean): [x: number[], ...columns: Cell[][]] {
  const places = series.flatMap(({ x = [] }) => x.filter((place) => place !== null));
  const all = [...new Set(places)].sort((a, b) => a - b);
  const shown = (value: Cell) => (log && value != null && value <= 0 ? null : (value ?? undefined));
  return [
    all,
    ...series.map(({ x = [], y }) => {
      const known = new Map(x.map((place, i) => [place, y[i]]));
      return all.map((place) => shown(known.get(place)));
    }),
  ];
}
