/** Read a JSON schema: references, nullable types, ranges, unions, and defaults for the missing fields of a spec. */

import type { Json, Schema, Spec } from "../../api/types";
import { isObject } from "../../run/spec/difference";

export interface Range {
  low?: number;
  lowOpen?: boolean;
  high?: number;
  highOpen?: boolean;
}

/** Follow a reference; fields beside it (a default, a description) win. */
export function resolve(schema: Schema, root: Schema): Schema {
  const reference = schema.$ref ?? only(schema.allOf)?.$ref;
  if (typeof reference !== "string") return schema;
  const target = reference
    .split("/")
    .slice(1)
    .reduce<Schema>((part, key) => (part[key] ?? {}) as Schema, root);
  const { $ref: _, allOf: __, ...beside } = schema;
  return resolve({ ...target, ...beside }, root);
}

function only(list: Json | undefined): Schema | undefined {
  return Array.isArray(list) && list.length === 1 ? (list[0] as Schema) : undefined;
}

/** The schema without null; the schema itself if null is not allowed. */
export function notNull(schema: Schema, root: Schema): Schema {
  if (!Array.isArray(schema.anyOf)) return schema;
  const rest = (schema.anyOf as Schema[]).filter((option) => option.type !== "null");
  if (rest.length === schema.anyOf.length || rest.length !== 1) return schema;
  return resolve(rest[0]!, root);
}

export function rangeOf(schema: Schema): Range {
  const { minimum, exclusiveMinimum, maximum, exclusiveMaximum } = schema;
  const low = minimum ?? exclusiveMinimum;
  const high = maximum ?? exclusiveMaximum;
  return {
    ...(typeof low === "number" && { low, lowOpen: minimum === undefined }),
    ...(typeof high === "number" && { high, highOpen: maximum === undefined }),
  };
}

/** The default of a schema; of an object, the defaults of its parts. */
export function defaultOf(schema: Schema, root: Schema): Json {
  const full = resolve(schema, root);
  if (full.default !== undefined) return full.default;
  if (Array.isArray(full.enum)) return full.enum[0]!;
  if (full.const !== undefined) return full.const;
  if (full.type === "array") return sampleOf(full, root);
  const properties = Object.entries((full.properties ?? {}) as Record<string, Schema>);
  if (properties.length === 0) return null;
  return Object.fromEntries(properties.map(([key, part]) => [key, defaultOf(part, root)]));
}

/** The fewest allowed items: numbers that count up, pairs that make a zigzag. */
function sampleOf(schema: Schema, root: Schema): Json {
  const item = resolve((schema.items ?? {}) as Schema, root);
  const whole = (item.prefixItems as Schema[] | undefined)?.[0]?.type === "integer";
  const pair = (i: number) => (whole ? [i, i + 1] : [i, i % 2]);
  return Array.from({ length: Number(schema.minItems ?? 0) }, (_, i) =>
    item.type === "array" ? pair(i) : defaultOf(item, root),
  );
}

/** The field that names each of several parts. */
export function tagOf(parts: Schema[]): string {
  const [first, ...rest] = parts.map((part) => (part.properties ?? {}) as Record<string, Schema>);
  const fixed = (part: Record<string, Schema>, key: string) =>
    part[key] !== undefined && ("const" in part[key] || Array.isArray(part[key].enum));
  const found = Object.keys(first ?? {}).find(
    (key) => "const" in first![key]! && rest.every((part) => fixed(part, key)),
  );
  if (found === undefined) throw new Error("A union needs a field with a constant in each of its parts.");
  return found;
}

export function withDefaults(schema: Schema, spec: Spec): Spec {
  return fill(schema, schema, current(spec)) as Spec;
}

/** Drop the versions of plug-ins, because a new run takes the current ones. */
function current(value: Json): Json {
  if (Array.isArray(value)) return value.map(current);
  if (!isObject(value)) return value;
  if (typeof value.source === "string" && isObject(value.settings)) return { settings: value.settings };
  const parts = Object.entries(value);
  // A creature never changes.
  return Object.fromEntries(parts.map(([key, part]) => [key, key === "creature" ? part : current(part)]));
}

function fill(part: Schema, root: Schema, value: Json | undefined): Json {
  const schema = notNull(resolve(part, root), root);
  if (value === undefined) return defaultOf(part, root);
  if (Array.isArray(value)) {
    const item = schema.items as Schema | undefined;
    return item ? value.map((one) => fill(item, root, one)) : value;
  }
  if (!isObject(value)) return value;
  if (Array.isArray(schema.oneOf)) return fillUnion(schema, root, value);
  return fillProperties(schema, root, value);
}

function fillProperties(schema: Schema, root: Schema, value: Spec): Spec {
  const properties = Object.entries((schema.properties ?? {}) as Record<string, Schema>);
  const inside = properties.map(([key, part]) => [key, fill(part, root, value[key])]);
  return { ...value, ...Object.fromEntries(inside) };
}

/** The named part with its defaults, or the default part. */
function fillUnion(schema: Schema, root: Schema, value: Spec): Json {
  const parts = (schema.oneOf as Schema[]).map((part) => resolve(part, root));
  const tag = tagOf(parts);
  const defaultTag = isObject(schema.default) ? schema.default[tag] : undefined;
  const named = value[tag] ?? defaultTag ?? namesOf(parts[0]!, tag)[0]!;
  const selected = parts.find((part) => namesOf(part, tag).includes(named));
  return selected ? fillProperties(selected, root, { [tag]: named, ...value }) : value;
}

function namesOf(part: Schema, tag: string): Json[] {
  const field = (part.properties as Record<string, Schema>)[tag]!;
  return (field.enum as Json[] | undefined) ?? [field.const!];
}

export function join(path: string, key: string): string {
  return path ? `${path}.${key}` : key;
}

export function text(value: Json | undefined): string {
  return typeof value === "string" ? value.replaceAll("`", "") : "";
}
