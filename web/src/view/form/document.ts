/** The spec under a form: reading, changing and checking its values by path. */

import type { FieldError, Json, Spec } from "../../api/types";
import { number } from "../format";
import type { Field, NumberField, Section } from "./fields";

export function valueAt(document: Json, path: string): Json {
  const keys = path === "" ? [] : path.split(".");
  return keys.reduce<Json>((part, key) => {
    if (part === null || typeof part !== "object") return null;
    return (part as Record<string, Json>)[key] ?? null;
  }, document);
}

/** The document with another value at the path; nothing is changed in place. */
export function withValue(document: Json, path: string, value: Json): Json {
  if (path === "") return value;
  const [key, ...rest] = path.split(".") as [string, ...string[]];
  if (Array.isArray(document)) {
    return document.map((item, i) =>
      String(i) === key ? withValue(item, rest.join("."), value) : item,
    );
  }
  const parts = (document ?? {}) as Spec;
  return { ...parts, [key]: withValue(parts[key] ?? null, rest.join("."), value) };
}

/** What a person typed into a number field: a number, null for empty, else the text itself. */
export function typed(text: string): Json {
  const trimmed = text.trim();
  if (trimmed === "") return null;
  const value = Number(trimmed.replace("−", "-"));
  return Number.isFinite(value) ? value : text;
}

/** What is wrong with a number, as far as the schema alone can say; else null. */
export function complaint(field: NumberField, value: Json): string | null {
  if (value === null) return field.nullable ? null : "Needs a number.";
  if (typeof value !== "number") return `Needs a number, got “${String(value)}”.`;
  if (field.whole && !Number.isInteger(value)) return `Needs a whole number, got ${value}.`;
  const { low, lowOpen, high, highOpen } = field.range;
  if (low !== undefined && (value < low || (lowOpen && value === low))) {
    return `Needs ${lowOpen ? "more than" : "at least"} ${number(low, 6)}.`;
  }
  if (high !== undefined && (value > high || (highOpen && value === high))) {
    return `Needs ${highOpen ? "less than" : "at most"} ${number(high, 6)}.`;
  }
  return null;
}

/** Messages by path; `descriptors[0].low` and `descriptors.0.low` are the same place. */
export function messagesByPath(errors: FieldError[]): Map<string, string[]> {
  const messages = new Map<string, string[]>();
  for (const { field, message } of errors) {
    const path = field.replace(/\[(\d+)\]/g, ".$1").replace(/^(body\.|\.)/, "");
    const known = messages.get(path) ?? [];
    if (!known.includes(message)) messages.set(path, [...known, message]);
  }
  return messages;
}

/** What the schema alone finds wrong with the numbers of a document. */
export function complaints(form: Section, document: Json): FieldError[] {
  return leavesOf(form, document).flatMap((field) => {
    const message = field.kind === "number" && complaint(field, valueAt(document, field.path));
    return message ? [{ field: field.path, message }] : [];
  });
}

function leavesOf(field: Field, document: Json): Field[] {
  if (field.kind === "section") return field.fields.flatMap((part) => leavesOf(part, document));
  if (field.kind !== "rows") return [field];
  const items = valueAt(document, field.path);
  return (Array.isArray(items) ? items : []).flatMap((_, i) => leavesOf(field.row(i), document));
}
