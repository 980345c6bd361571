/** Axes of a map: descriptors of the archive, recorded measures and fitness. */

import type { Archive, Axis, Run } from "../api/types";
import type { Elite, Elites, Measures } from "../store/elites";
import { words } from "../ui/format";
import { type Scale, roundStep } from "../charts/plot/scale";
import { text } from "./text";

export const FITNESS = "fitness";
/** Bins of an axis that is not an axis of the grid. */
const BINS = 24;

/** All measures that can be an axis, by name. */
export const choicesOf = (archive: Archive) => [
  ...archive.recorded.map(({ name, title }): [string, string] => [name, title]),
  [FITNESS, text.fitness] as [string, string],
];

/** The names of both axes: the requested ones, or the archive's first two, or fitness. */
export function namesOf(archive: Archive, x: string | null, y: string | null): [string, string] {
  const known = new Set(choicesOf(archive).map(([name]) => name));
  const learned = archive.recorded.filter(({ bins }) => bins).map(({ name }) => name);
  const defaults = [...learned, ...archive.axes.map(({ name }) => name), FITNESS];
  const first = x && known.has(x) ? x : defaults[0]!;
  return [first, y && known.has(y) ? y : (defaults.slice(0, 2).find((name) => name !== first) ?? FITNESS)];
}

/** The container of an archive that does not keep one elite in each cell; null for cells. */
export const containerOf = ({ spec }: Run) =>
  (spec.archive as { container?: Container | null } | undefined)?.container ?? null;

interface Container {
  kind: string;
  /** The second objective of a front. */
  measure?: string;
}

/** The name of the second objective of fronts; fitness if there is none. */
export function objectiveOf(run: Run, { recorded }: Archive): string {
  const measure = containerOf(run)?.measure;
  return recorded.find(({ name }) => name === measure)?.name ?? FITNESS;
}

/** The names of measures that elites do not contain, which are fetched. */
export function missingOf(archive: Archive, names: string[]): string[] {
  const contained = [...archive.axes.map(({ name }) => name), FITNESS];
  return names.filter((name) => !contained.includes(name));
}

export const scaleOf = ({ scale, low, high }: Axis): Scale => ({ log: scale === "log10", low, high });

export interface MapAxis extends Axis, Measure {
  /** The bin of a cell, if this is an axis of the grid. */
  binOfCell: ((cell: number) => number) | null;
}

/** A measure of elites, with its title and unit. */
export interface Measure {
  name: string;
  title: string;
  unit: string;
  scale: Axis["scale"];
  valueOf: (elite: Elite) => number | null;
}

export function measureOf(name: string, archive: Archive, measures: Measures): Measure {
  const index = archive.axes.findIndex((axis) => axis.name === name);
  const recorded = archive.recorded.find((measure) => measure.name === name);
  const scale = archive.axes[index]?.scale ?? recorded?.scale ?? "linear";
  const common = { name, title: recorded?.title ?? words(name), unit: recorded?.unit ?? "", scale };
  if (index >= 0) return { ...common, valueOf: ({ descriptors }) => descriptors[index] ?? null };
  if (name === FITNESS) return { ...common, valueOf: ({ fitness }) => fitness };
  const column = measures.get(name);
  return { ...common, valueOf: ({ creature }) => column?.get(creature) ?? null };
}

export function axisOf(name: string, archive: Archive, elites: Elites, measures: Measures): MapAxis {
  const measure = measureOf(name, archive, measures);
  const index = archive.axes.findIndex((axis) => axis.name === name);
  if (index >= 0) {
    const bins = archive.kind === "cvt" ? BINS : archive.axes[index]!.bins;
    // The number of a pool's place does not tell where its elite lies.
    const binOfCell = archive.kind === "grid" ? binAlong(archive.axes, index) : null;
    return { ...archive.axes[index]!, ...measure, bins, binOfCell };
  }
  const recorded = archive.recorded.find((measure) => measure.name === name);
  if (recorded?.bins) {
    // A learned axis: its own ends and bins show each elite in its learned cell.
    return {
      ...measure,
      low: recorded.low ?? 0,
      high: recorded.high ?? 1,
      bins: recorded.bins,
      binOfCell: null,
    };
  }
  const values = [...elites.values()].map(measure.valueOf).filter((value) => value !== null);
  const defaults = [recorded?.low ?? 0, recorded?.high ?? 1] as const;
  const [low, high, bins] = endsOf(values, measure.scale, ...defaults);
  return { ...measure, low, high, bins, binOfCell: null };
}

/** The bin of a cell along one axis; cells count in C order. */
function binAlong(axes: readonly Axis[], index: number): (cell: number) => number {
  const after = axes.slice(index + 1).reduce((product, { bins }) => product * bins, 1);
  return (cell) => Math.floor(cell / after) % axes[index]!.bins;
}

/** Round ends around the values; without values, those of the measure. */
function endsOf(
  values: readonly number[],
  scale: Axis["scale"],
  low: number,
  high: number,
): [number, number, number] {
  if (values.length === 0) return [low, high, BINS];
  const most = values.reduce((a, b) => Math.max(a, b));
  const least = values.reduce((a, b) => Math.min(a, b));
  if (scale === "log10") {
    const from = Math.floor(Math.log10(Math.max(least, low)) + 1e-9);
    const to = Math.ceil(Math.log10(Math.max(most, low)) - 1e-9);
    return [10 ** from, 10 ** Math.max(to, from + 1), BINS];
  }
  if (values.every(Number.isInteger) && most - least < 4 * BINS) {
    const wide = Math.max(most + 1 - least, 4);
    return [least, least + wide, wide];
  }
  const step = roundStep(Math.max(most - least, 1e-9 * Math.abs(most), 1e-12) / 8);
  const from = step * Math.floor(least / step + 1e-9);
  return [from, Math.max(step * Math.ceil(most / step - 1e-9), from + step), BINS];
}
