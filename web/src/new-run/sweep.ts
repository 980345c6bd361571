/** The state of a sweep: seeds, and the typed values of the fields of a grid. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Experiment, FieldError, Spec, SweepRequest, Json } from "../api/types";
import { words } from "../ui/format";
import { leavesOf, numberError, typed, typedJson } from "./form/document";
import type { Leaf, Section } from "./form/fields";
import { text } from "./text";

interface Typed {
  seeds: string;
  axes: readonly Axis[];
  name: string;
}

const SINGLE: Typed = { seeds: "1", axes: [], name: "" };

/** Keep typed values while the spec changes; report fields that no longer exist. */
export function useSweepForm(form: Section, spec: Spec, experiment: Experiment) {
  const [typed, setTyped] = useState(SINGLE);
  useEffect(() => setTyped(SINGLE), [experiment]);
  const read = useMemo(() => readAll(form, spec, hasSeed(experiment), typed), [form, spec, typed]);
  const change = (next: Partial<Typed>) => setTyped((now) => ({ ...now, ...next }));
  return { ...typed, ...read, change };
}

export type SweepForm = ReturnType<typeof useSweepForm>;

function readAll(form: Section, spec: Spec, seeded: boolean, typed: Typed) {
  const fields = sweepable(form, spec);
  const { seeds, problem } = seeded ? readSeeds(typed.seeds) : { seeds: 1, problem: null };
  const parsed = typed.axes.map(({ path, text: typed }) => {
    const field = fields.find((one) => one.path === path);
    return field ? readValues(field, typed) : { values: [], problem: text.fieldGone };
  });
  const total = parsed.reduce((product, { values }) => product * values.length, seeds);
  const many = total > MAX_RUNS ? text.tooManyRuns(MAX_RUNS.toLocaleString("en"), total) : null;
  const problems = { seeds: problem, axes: parsed.map((one) => one.problem), total: many };
  const valid = !problem && !many && parsed.every((one) => one.problem === null);
  const grid = Object.fromEntries(typed.axes.map(({ path }, i) => [path, parsed[i]!.values]));
  const isGrid = valid && (total > 1 || typed.axes.length > 0);
  // A single run is no sweep.
  const request: SweepRequest | null = isGrid ? { spec, seeds, grid, name: typed.name.trim() || null } : null;
  return { seeded, fields, problems, total, request };
}

/** True if more than one run is asked for, even with invalid values. */
export const isSweep = ({ seeds, axes }: SweepForm) => axes.length > 0 || seeds.trim() !== "1";

/** Errors of the server for one field of the grid, or for the seeds. */
export function errorsAt(errors: readonly FieldError[], path: string): string[] {
  const matching = errors.filter(({ field }) => field === path || field.startsWith(`${path}[`));
  return matching.map(({ reason }) => reason);
}

export interface Axis {
  path: string;
  text: string;
}

export function sweepable(form: Section, spec: Spec): Leaf[] {
  const leaves = leavesOf(form, spec) as Leaf[];
  return leaves.filter(({ kind, path }) => (kind as string) !== "constant" && path !== "seed");
}

/** Section and title of a field: “World: viscosity”. */
export function nameOf({ path, title }: Leaf): string {
  const around = path.split(".").slice(0, -1).map(words);
  return around.length > 0 ? `${around.join(" ")}: ${title.toLowerCase()}` : title;
}

interface ParsedValues {
  values: Json[];
  problem: string | null;
}

/** Values between commas or blanks, or a JSON list. */
export function readValues(field: Leaf, input: string): ParsedValues {
  const values = valuesOf(field, input.trim());
  if (values === null) return { values: [], problem: text.needsList };
  if (values.length === 0) return { values, problem: text.needsValues };
  const error = values.map((value) => valueError(field, value)).find((message) => message !== null);
  const duplicate = values.find((value, i) => values.findIndex((one) => same(one, value)) < i);
  const repeated = duplicate === undefined ? null : text.repeated(JSON.stringify(duplicate));
  return { values, problem: error ?? repeated };
}

const COMPOUND = ["list", "multiple", "nested"];

function valuesOf(field: Leaf, text: string): Json[] | null {
  if (text.startsWith("[") || COMPOUND.includes(field.kind)) return listOf(text);
  return text
    .split(/[\s,;]+/)
    .filter(Boolean)
    .map((word) => valueOf(field, word));
}

function listOf(text: string): Json[] | null {
  const list = text === "" ? [] : typedJson(text);
  return Array.isArray(list) ? list : null;
}

const TRUE_WORDS = ["true", "on", "yes"];
const FALSE_WORDS = ["false", "off", "no"];
const NULL_WORDS = ["null", "none", "auto"];

function valueOf(field: Leaf, word: string): Json {
  if (field.kind === "flag" && TRUE_WORDS.includes(word.toLowerCase())) return true;
  if (field.kind === "flag" && FALSE_WORDS.includes(word.toLowerCase())) return false;
  if ("nullable" in field && field.nullable && NULL_WORDS.includes(word)) return null;
  if (field.kind === "number") return typed(word);
  if (field.kind !== "choice") return word;
  return field.options.find((option) => String(option) === word) ?? word;
}

function valueError(field: Leaf, value: Json): string | null {
  if (field.kind === "number") return numberError(field, value);
  if (field.kind === "flag" && typeof value !== "boolean") return text.needsFlag(value);
  if (field.kind !== "choice" || value === null) return null;
  const known = field.options.includes(value);
  return known ? null : text.needsOption(field.options.join(", "), String(value));
}

const same = (one: Json, other: Json) => JSON.stringify(one) === JSON.stringify(other);

export function readSeeds(input: string): { seeds: number; problem: string | null } {
  const seeds = typed(input);
  const isWhole = typeof seeds === "number" && Number.isInteger(seeds);
  if (isWhole && seeds >= 1 && seeds <= MAX_RUNS) return { seeds, problem: null };
  return { seeds: 1, problem: text.needsSeeds(MAX_RUNS.toLocaleString("en")) };
}

/** The largest number of runs in one request. */
const MAX_RUNS = 1000;

const hasSeed = ({ schema }: Experiment) => "seed" in ((schema.properties ?? {}) as Record<string, Json>);
