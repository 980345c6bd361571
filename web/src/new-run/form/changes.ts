/** Changes of a spec, and the preset that it equals. */

import type { Experiment, Json, Preset, Spec } from "../../api/types";
import { isObject } from "../../run/spec/difference";
import { join } from "./schema";

/** Paths of differing values; parts and lists of another shape differ as a whole. */
export function changedPaths(a: Json, b: Json, path = ""): string[] {
  if (isObject(a) && isObject(b) && sameKeys(a, b)) {
    return keysOf(a, b).flatMap((key) => changedPaths(a[key] ?? null, b[key] ?? null, join(path, key)));
  }
  if (Array.isArray(a) && Array.isArray(b) && a.length === b.length && a.every(isObject)) {
    return a.flatMap((item, i) => changedPaths(item, b[i]!, join(path, String(i))));
  }
  return JSON.stringify(a) === JSON.stringify(b) ? [] : [path];
}

/** Fields that a document has only where it names a plug-in. */
const OF_PLUGINS = ["plugin", "plugins"];

function keysOf(...parts: Spec[]): string[] {
  return [...new Set(parts.flatMap(Object.keys))];
}

function sameKeys(a: Spec, b: Spec): boolean {
  return keysOf(a, b).every((key) => OF_PLUGINS.includes(key) || (key in a && key in b));
}

/** The number of paths in a part of the spec. */
export function countWithin(paths: Iterable<string>, part: string): number {
  return [...paths].filter((path) => path === part || path.startsWith(`${part}.`)).length;
}

/** The preset with the same spec, whatever the seed. */
export function equalPreset(spec: Spec, experiments: Experiment[]): Preset | null {
  const own = experiments.find(({ experiment }) => experiment === spec.experiment);
  const same = (preset: Preset) => changedPaths(spec, preset.spec).every((path) => path === "seed");
  return own?.presets.find(same) ?? null;
}
