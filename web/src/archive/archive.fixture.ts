/** An archive with three axes, for tests of the map. */

import type { Archive } from "../api/types";
import type { Elite, Elites, Measures } from "../store/elites";
import { axisOf } from "./axes";
import { project } from "./projection";

export const AXES = [
  { name: "a", low: 0, high: 1, bins: 2, scale: "linear" },
  { name: "b", low: 1, high: 100, bins: 4, scale: "log10" },
  { name: "c", low: 0, high: 1, bins: 3, scale: "linear" },
] as const;

export const recorded = ["a", "b", "c", "turning", "nodes"].map((name) => {
  return { name, title: name.toUpperCase(), unit: "rad", low: 0.01, high: 1, scale: "linear" };
});

export function archiveOf(count: number, kind: Archive["kind"] = "grid"): Archive {
  return { kind, axes: AXES.slice(0, count), recorded } as unknown as Archive;
}

export function elite(fitness: number, ...descriptors: number[]): Elite {
  return { fitness, descriptors, generation: 1, creature: `c${fitness}`, trusted: null, reportedAt: 1 };
}

/** Elites by cell. */
export const elitesOf = (elites: Record<number, Elite>): Elites =>
  new Map(Object.entries(elites).map(([cell, each]) => [Number(cell), each]));

/** Measures by name and creature. */
export const measuresOf = (measures: Record<string, Record<string, number>>): Measures =>
  new Map(Object.entries(measures).map(([name, column]) => [name, new Map(Object.entries(column))]));

export const NONE: Measures = new Map();

export const over = (archive: Archive, elites: Elites, names: [string, string], measures = NONE) =>
  project(elites, [axisOf(names[0], archive, elites, measures), axisOf(names[1], archive, elites, measures)]);
