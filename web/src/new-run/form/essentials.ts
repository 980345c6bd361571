/** The few settings that most people change, and a search among all others. */

import type { FieldError, Json } from "../../api/types";
import { leavesOf } from "./document";
import type { Field, Leaf, Section, Union } from "./fields";
import { text } from "./text";

/** A form with fewer essential settings is short enough to be shown whole. */
const FEWEST = 4;

/** The essential settings of a spec, with titles that stand alone; empty if it has only a few. */
export function essentialsOf(form: Section, document: Json): Leaf[] {
  const leaves = new Map(leavesOf(form, document).map((field) => [field.path, field as Leaf]));
  const found = Object.entries(text.essentials).flatMap(([path, [title, help]]) => {
    const field = leaves.get(path);
    return field ? [{ ...field, title, help }] : [];
  });
  return found.length < FEWEST ? [] : found;
}

type Part = Section | Union;

/** The parts with the settings whose title, path or help contains all typed words. */
export function searched(parts: readonly Part[], typed: string): Part[] {
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return [...parts];
  return parts.flatMap((part) => (within(part, words) as Part | null) ?? []);
}

function within(field: Field, words: readonly string[]): Field | null {
  const about = `${field.title} ${field.path.replace(/[._]/g, " ")} ${field.help}`.toLowerCase();
  if (words.every((word) => about.includes(word))) return field;
  if (field.kind === "section") {
    const fields = field.fields.flatMap((each) => within(each, words) ?? []);
    return fields.length > 0 ? { ...field, fields } : null;
  }
  const insides =
    field.kind === "union" ? [...field.parts.values()] : field.kind === "rows" ? [field.row(0)] : [];
  return insides.some((inside) => within(inside, words)) ? field : null;
}

/** A number that mends a wrong one: the nearest permitted, or the bound of an error; else null. */
export function mendOf(field: Leaf, value: Json, errors: readonly FieldError[]): number | null {
  if (field.kind !== "number" || typeof value !== "number") return null;
  const { low = -Infinity, lowOpen, high = Infinity, highOpen } = field.range;
  if ((lowOpen && value <= low) || (highOpen && value >= high)) return null;
  const whole = field.whole ? Math.round(value) : value;
  const mended = Math.min(high, Math.max(low, whole));
  if (mended !== value) return mended;
  for (const { least, most } of errors) {
    if (typeof least === "number") return field.whole ? Math.ceil(least) : least;
    if (typeof most === "number") return field.whole ? Math.floor(most) : most;
  }
  return null;
}
