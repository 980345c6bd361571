/** Defaults of a schema for the missing fields of a spec. */

import type { Json, Schema, Spec } from "../../api/types";
import { tagOf } from "./fields";
import { isObject } from "../../run/spec/difference";
import { defaultOf, notNull, resolve } from "./schema";

export function completed(schema: Schema, spec: Spec): Spec {
  return filled(schema, schema, latest(spec)) as Spec;
}

/** Drop the versions of plug-ins, because a new run takes the current ones. */
function latest(value: Json): Json {
  if (Array.isArray(value)) return value.map(latest);
  if (!isObject(value)) return value;
  if (typeof value.source === "string" && isObject(value.settings)) return { settings: value.settings };
  const parts = Object.entries(value);
  // A creature never changes.
  return Object.fromEntries(parts.map(([key, part]) => [key, key === "creature" ? part : latest(part)]));
}

function filled(part: Schema, root: Schema, value: Json | undefined): Json {
  const schema = notNull(resolve(part, root), root);
  if (value === undefined) return defaultOf(part, root);
  if (Array.isArray(value)) {
    const item = schema.items as Schema | undefined;
    return item ? value.map((one) => filled(item, root, one)) : value;
  }
  if (!isObject(value)) return value;
  if (Array.isArray(schema.oneOf)) return filledUnion(schema, root, value);
  return filledProperties(schema, root, value);
}

function filledProperties(schema: Schema, root: Schema, value: Spec): Spec {
  const properties = Object.entries((schema.properties ?? {}) as Record<string, Schema>);
  const inside = properties.map(([key, part]) => [key, filled(part, root, value[key])]);
  return { ...value, ...Object.fromEntries(inside) };
}

/** The named part with its defaults, or the default part. */
function filledUnion(schema: Schema, root: Schema, value: Spec): Json {
  const parts = (schema.oneOf as Schema[]).map((part) => resolve(part, root));
  const tag = tagOf(parts);
  const defaultTag = isObject(schema.default) ? schema.default[tag] : undefined;
  const named = value[tag] ?? defaultTag ?? namesOf(parts[0]!, tag)[0]!;
  const selected = parts.find((part) => namesOf(part, tag).includes(named));
  return selected ? filledProperties(selected, root, { [tag]: named, ...value }) : value;
}

function namesOf(part: Schema, tag: string): Json[] {
  const field = (part.properties as Record<string, Schema>)[tag]!;
  return (field.enum as Json[] | undefined) ?? [field.const!];
}
