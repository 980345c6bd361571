/** Read a JSON schema: references, nullable types, ranges, defaults. */

import type { Json, Schema } from "../../api/types";

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

export function join(path: string, key: string): string {
  return path ? `${path}.${key}` : key;
}

export function text(value: Json | undefined): string {
  return typeof value === "string" ? value.replaceAll("`", "") : "";
}
