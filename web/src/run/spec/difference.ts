/** Differences between specs: paths, and the value of each spec. */

import type { Json, Spec } from "../../api/types";
import { DASH, number } from "../../ui/format";
import { text } from "./text";

export interface Difference {
  /** As in errors of the server: `descriptors.0.bins`. */
  path: string;
  /** One for each spec, in their order; undefined where a spec has no such field. */
  values: (Json | undefined)[];
}

/** The fields whose values differ between specs. */
export function differences(specs: readonly Spec[]): Difference[] {
  const flat = specs.map((spec) => new Map(leavesOf(spec, "")));
  const paths = [...new Set(flat.flatMap((leaves) => [...leaves.keys()]))];
  return paths
    .map((path) => ({ path, values: flat.map((leaves) => leaves.get(path)) }))
    .filter(({ values }) => values.some((value) => JSON.stringify(value) !== JSON.stringify(values[0])));
}

/** The group of each spec: equal ones, apart from the seed, have one number, counted from 0. */
export function groupsOf(specs: readonly Spec[]): number[] {
  const differing = differences(specs).filter(({ path }) => path !== "seed");
  const keys = specs.map((_, i) => JSON.stringify(differing.map(({ values }) => values[i] ?? null)));
  const known = [...new Set(keys)];
  return keys.map((key) => known.indexOf(key));
}

/** A value as a table shows it. */
export function valueText(value: Json | undefined): string {
  if (value === undefined) return DASH;
  if (value === null || (Array.isArray(value) && value.length === 0)) return text.none;
  if (typeof value === "boolean") return value ? text.yes : text.no;
  if (typeof value === "number") return number(value, 9);
  if (typeof value === "string") return value;
  return Array.isArray(value) ? value.map(valueText).join(", ") : JSON.stringify(value);
}

/** Lists of plain values are one value. */
function leavesOf(value: Json, path: string): [path: string, value: Json][] {
  if (Array.isArray(value) && value.some(isCompound)) {
    return value.flatMap((item, i) => leavesOf(item, `${path}.${i}`));
  }
  if (!isObject(value) || Object.keys(value).length === 0) return [[path, value]];
  const inside = (key: string) => (path ? `${path}.${key}` : key);
  return Object.entries(value).flatMap(([key, part]) => leavesOf(part, inside(key)));
}

const isCompound = (value: Json) => value !== null && typeof value === "object";

export const isObject = (value: Json | undefined): value is Spec =>
  value !== undefined && isCompound(value) && !Array.isArray(value);
