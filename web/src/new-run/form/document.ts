/** The spec under a form: reading, changing, comparing and checking its values by path. */

import type { FieldError, Json, Spec, Experiment, Preset } from "../../api/types";
import { parseJson } from "../../decode/json";
import { isObject } from "../../run/spec/difference";
import { number } from "../../ui/format";
import type { Field, List, NumberField, Section, Multiple, Union } from "./fields";
import { join } from "./schema";
import { text } from "./text";

export function valueAt(document: Json, path: string): Json {
  const keys = path === "" ? [] : path.split(".");
  return keys.reduce<Json>((part, key) => {
    if (part === null || typeof part !== "object") return null;
    return (part as Record<string, Json>)[key] ?? null;
  }, document);
}

export function withValue(document: Json, path: string, value: Json): Json {
  if (path === "") return value;
  const [key, ...rest] = path.split(".") as [string, ...string[]];
  if (Array.isArray(document)) {
    return document.map((item, i) => (String(i) === key ? withValue(item, rest.join("."), value) : item));
  }
  const parts = (document ?? {}) as Spec;
  return { ...parts, [key]: withValue(parts[key] ?? null, rest.join("."), value) };
}

/** A typed number; null for empty text, and other text as it is. */
export function typed(text: string): Json {
  const trimmed = text.trim();
  if (trimmed === "") return null;
  const value = Number(trimmed.replace("−", "-"));
  return Number.isFinite(value) ? value : text;
}

export function numberError(field: NumberField, value: Json): string | null {
  if (value === null) return field.nullable ? null : text.needsNumber;
  if (typeof value !== "number") return text.notANumber(String(value));
  if (field.whole && !Number.isInteger(value)) return text.notWhole(value);
  const { low, lowOpen, high, highOpen } = field.range;
  if (low !== undefined && (value < low || (lowOpen && value === low))) {
    return text.tooLow(lowOpen, number(low, 6));
  }
  if (high !== undefined && (value > high || (highOpen && value === high))) {
    return text.tooHigh(highOpen, number(high, 6));
  }
  return null;
}

/**
 * Errors by the path of the element that shows them: the named field, or else the part around it.
 * `descriptors[0].low` and `descriptors.0.low` are the same place.
 */
export function errorsByPath(errors: FieldError[], form: Section, document: Json): Map<string, FieldError[]> {
  const shown = new Set(messagePaths(form, document));
  const found = new Map<string, FieldError[]>();
  for (const error of errors) {
    let path = error.field.replace(/\[(\d+)\]/g, ".$1").replace(/^\./, "");
    while (!shown.has(path)) path = path.slice(0, Math.max(0, path.lastIndexOf(".")));
    found.set(path, [...(found.get(path) ?? []), error]);
  }
  return found;
}

/** A typed list of numbers; other words stay text. */
export function typedList(text: string): Json[] {
  return text
    .split(/[\s,;]+/)
    .filter(Boolean)
    .map(typed);
}

/** Typed JSON; other text as it is, also that in which a name is given twice. */
export function typedJson(text: string): Json {
  try {
    return parseJson(text);
  } catch {
    return text;
  }
}

export function schemaErrors(form: Section, document: Json): FieldError[] {
  return leavesOf(form, document).flatMap((field) => {
    const reason = leafError(field, valueAt(document, field.path));
    return reason ? [{ field: field.path, reason }] : [];
  });
}

function leafError(field: Field, value: Json): string | null {
  if (field.kind === "number") return numberError(field, value);
  if (field.kind === "list") return listError(field, value);
  if (field.kind === "multiple") return multipleError(field, value);
  if (field.kind === "nested" && !Array.isArray(value)) return text.needsNested;
  return null;
}

function listError({ item, minItems, maxItems }: List, value: Json): string | null {
  const items = Array.isArray(value) ? value : [];
  const wrong = items.map((one) => numberError(item, one)).find((message) => message !== null);
  if (wrong) return wrong;
  if (items.length < minItems) return text.tooFew(minItems);
  return items.length > maxItems ? text.tooManyNumbers(maxItems) : null;
}

function multipleError({ minItems }: Multiple, value: Json): string | null {
  const selected = Array.isArray(value) ? value.length : 0;
  return selected < minItems ? text.selectMore(minItems) : null;
}

export function partOf(union: Union, document: Json): Section | null {
  return union.parts.get(String(valueAt(document, `${union.path}.${union.tag}`))) ?? null;
}

/** The document with another value; values that follow from a changed choice are removed. */
export function withChoice(document: Json, section: Section, field: Field, value: Json): Json {
  const next = withValue(document, field.path, value);
  const following = section.following.map((name) => join(section.path, name));
  if (field.kind !== "choice" || following.includes(field.path)) return next;
  const left = following.reduce((changed, path) => withValue(changed, path, null), next);
  return withPlugin(left, section, field, value);
}

/** Add or remove the settings of a plug-in with its name. */
function withPlugin(document: Json, { path, settings }: Section, field: Field, value: Json): Json {
  const plugin = join(path, "plugin");
  const initial = settings?.path === field.path ? settings.initial[String(value)] : undefined;
  if (initial === undefined && valueAt(document, plugin) === null) return document;
  return withValue(document, plugin, initial ?? null);
}

/** True if a field belongs to the choices of a document. */
export function isApplicable({ when }: Field, document: Json): boolean {
  return when === undefined || valueAt(document, when.path) === when.is;
}

export function isOff(section: Section, document: Json): boolean {
  return section.initial !== undefined && valueAt(document, section.path) === null;
}

/** Fields within a field, as far as the document has them. */
function applicableFields(field: Field, document: Json): Field[] {
  return within(field, document).filter((each) => isApplicable(each, document));
}

function within(field: Field, document: Json): Field[] {
  if (field.kind === "union") return partOf(field, document)?.fields ?? [];
  if (field.kind === "section") return isOff(field, document) ? [] : field.fields;
  if (field.kind !== "rows") return [];
  const items = valueAt(document, field.path);
  return (Array.isArray(items) ? items : []).map((_, i) => field.row(i));
}

const COMPOUND = ["union", "section", "rows"];

export function leavesOf(field: Field, document: Json): Field[] {
  if (!COMPOUND.includes(field.kind)) return [field];
  return applicableFields(field, document).flatMap((each) => leavesOf(each, document));
}

/** Every path at which a form can show a message; that of the whole form is empty. */
export function messagePaths(field: Field, document: Json): string[] {
  if (field.kind === "constant") return [];
  const inside = applicableFields(field, document).flatMap((each) => messagePaths(each, document));
  return [field.path, ...inside];
}

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

export function countWithin(paths: Iterable<string>, part: string): number {
  return [...paths].filter((path) => path === part || path.startsWith(`${part}.`)).length;
}

/** The preset with the same spec, whatever the seed. */
export function equalPreset(spec: Spec, experiments: Experiment[]): Preset | null {
  const experiment = experiments.find((one) => one.experiment === spec.experiment);
  const same = (preset: Preset) => changedPaths(spec, preset.spec).every((path) => path === "seed");
  return experiment?.presets.find(same) ?? null;
}
