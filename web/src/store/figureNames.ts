/** Figures of a summary, by the names in the server's table. */

import table from "../api/figures.json";
import type { Values } from "../api/types";

/** A kind of figures; its `*` stands for a name that runs choose. */
export type Kind = keyof typeof table;

const FLAGS = Object.entries(table) as [Kind, { adds: boolean; curve: boolean }][];

/** The name that a run chose; null for another kind of figures. */
export function keyOf(kind: Kind, name: string): string | null {
  const [head, tail] = kind.split("*") as [string, string];
  const inside = name.startsWith(head) && name.endsWith(tail) && name.length > head.length + tail.length;
  return inside ? name.slice(head.length, name.length - tail.length) : null;
}

export const nameOf = (kind: Kind, key: string) => kind.replace("*", key);

/** The values of a kind, by the names that the run chose. */
export function valuesOf<T>(kind: Kind, summary: { readonly [name: string]: T }): [key: string, value: T][] {
  return Object.entries(summary).flatMap(([name, value]): [string, T][] => {
    const key = keyOf(kind, name);
    return key === null ? [] : [[key, value]];
  });
}

const flagsOf = (name: string) => FLAGS.find(([kind]) => keyOf(kind, name) !== null)?.[1];

/** True for figures that make a curve. */
export const isCurve = (name: string) => flagsOf(name)?.curve !== false;

/** True for counts, which are added up when curves are thinned out. */
export const isCount = (name: string) => flagsOf(name)?.adds === true;

/** The limit that ended a search early, and its last generation; null if it met none. */
export function endOf(summary: Values | null): [limit: string, generation: number] | null {
  const found = valuesOf("ended.*", summary ?? {}).find(([, value]) => typeof value === "number");
  return found ? [found[0], found[1] as number] : null;
}
