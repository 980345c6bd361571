/** Read the typed values of the fields of a sweep. */

import type { Experiment, Json, Spec } from "../api/types";
import { words } from "../ui/format";
import { complaint, leavesOf, typed } from "./form/document";
import type { Leaf, Section } from "./form/fields";
import { text } from "./text";

/** One field of a grid, with the typed values. */
export interface Axis {
  path: string;
  text: string;
}

/** Fields that a grid can run over; seeds have an entry of their own. */
export function sweepable(form: Section, spec: Spec): Leaf[] {
  const leaves = leavesOf(form, spec) as Leaf[];
  return leaves.filter(({ kind, path }) => (kind as string) !== "constant" && path !== "seed");
}

/** Section and title of a field: “World: viscosity”. */
export function nameOf({ path, title }: Leaf): string {
  const around = path.split(".").slice(0, -1).map(words);
  return around.length > 0 ? `${around.join(" ")}: ${title.toLowerCase()}` : title;
}

export interface Reading {
  values: Json[];
  /** The error; null for valid values. */
  problem: string | null;
}

/** Values between commas or blanks, or a JSON list. */
export function readValues(field: Leaf, input: string): Reading {
  const values = valuesOf(field, input.trim());
  if (values === null) return { values: [], problem: text.needsList };
  if (values.length === 0) return { values, problem: text.needsValues };
  const wrong = values.map((value) => wrongWith(field, value)).find((said) => said !== null);
  const twice = values.find((value, i) => values.findIndex((one) => same(one, value)) < i);
  const repeated = twice === undefined ? null : text.repeated(JSON.stringify(twice));
  return { values, problem: wrong ?? repeated };
}

const COMPOUND = ["list", "several", "nested"];

function valuesOf(field: Leaf, text: string): Json[] | null {
  if (text.startsWith("[") || COMPOUND.includes(field.kind)) return listOf(text);
  return text
    .split(/[\s,;]+/)
    .filter(Boolean)
    .map((word) => valueOf(field, word));
}

function listOf(text: string): Json[] | null {
  if (text === "") return [];
  try {
    const found = JSON.parse(text) as Json;
    return Array.isArray(found) ? found : null;
  } catch {
    return null;
  }
}

const FLAGS: Record<string, boolean> = {
  true: true,
  on: true,
  yes: true,
  false: false,
  off: false,
  no: false,
};
const NOTHING = ["null", "none", "auto"];

function valueOf(field: Leaf, word: string): Json {
  if (field.kind === "flag") return FLAGS[word.toLowerCase()] ?? word;
  if ("nullable" in field && field.nullable && NOTHING.includes(word)) return null;
  if (field.kind === "number") return typed(word);
  if (field.kind !== "choice") return word;
  return field.options.find((option) => String(option) === word) ?? word;
}

function wrongWith(field: Leaf, value: Json): string | null {
  if (field.kind === "number") return complaint(field, value);
  if (field.kind === "flag" && typeof value !== "boolean") return text.needsFlag(value);
  if (field.kind !== "choice" || value === null) return null;
  const known = field.options.includes(value);
  return known ? null : text.needsOption(field.options.join(", "), String(value));
}

const same = (one: Json, other: Json) => JSON.stringify(one) === JSON.stringify(other);

/** The typed number of seeds, or an error. */
export function readSeeds(input: string): { seeds: number; problem: string | null } {
  const seeds = typed(input);
  const whole = typeof seeds === "number" && Number.isInteger(seeds);
  if (whole && seeds >= 1 && seeds <= MOST) return { seeds, problem: null };
  return { seeds: 1, problem: text.needsSeeds(MOST.toLocaleString("en")) };
}

/** The largest number of runs in one request. */
export const MOST = 1000;

/** True if an experiment depends on a random seed. */
export const hasSeed = ({ schema }: Experiment) =>
  "seed" in ((schema.properties ?? {}) as Record<string, Json>);
