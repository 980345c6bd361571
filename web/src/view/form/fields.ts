/** The fields of a form, read from a JSON schema. */

import type { Json, Schema } from "../../api/types";
import { words } from "../format";

interface Common {
  /** Where the value is in the spec: `world.viscosity`, `archive.descriptors.0.low`. */
  path: string;
  title: string;
  help: string;
}

export interface Section extends Common {
  kind: "section";
  fields: Field[];
}

export interface Rows extends Common {
  kind: "rows";
  row: (index: number) => Section;
  least: number;
  most: number;
  fresh: Json;
}

export interface NumberField extends Common {
  kind: "number";
  whole: boolean;
  nullable: boolean;
  unit: string;
  range: Range;
}

export interface Range {
  low?: number;
  lowOpen?: boolean;
  high?: number;
  highOpen?: boolean;
}

export interface Choice extends Common {
  kind: "choice";
  options: Json[];
}

export interface Flag extends Common {
  kind: "flag";
}

export interface TextField extends Common {
  kind: "text";
}

export interface Constant extends Common {
  kind: "constant";
}

export type Field = Section | Rows | NumberField | Choice | Flag | TextField | Constant;

export function formOf(schema: Schema): Section {
  return sectionOf(schema, schema, { path: "", title: "", help: text(schema.description) });
}

function sectionOf(schema: Schema, root: Schema, common: Common): Section {
  const properties = (schema.properties ?? {}) as Record<string, Schema>;
  const fields = Object.entries(properties).map(([key, property]) =>
    fieldOf(property, root, key, join(common.path, key)),
  );
  return { ...common, kind: "section", fields };
}

function fieldOf(property: Schema, root: Schema, key: string, path: string): Field {
  const schema = resolve(property, root);
  const inner = notNull(schema, root);
  const nullable = inner !== schema;
  const common = { path, title: words(key), help: text(schema.description) };
  if ("const" in inner) return { ...common, kind: "constant" };
  if (Array.isArray(inner.enum)) return { ...common, kind: "choice", options: inner.enum };
  switch (inner.type) {
    case "object":
      return sectionOf(inner, root, common);
    case "array":
      return rowsOf(inner, root, common);
    case "boolean":
      return { ...common, kind: "flag" };
    case "integer":
    case "number":
      return {
        ...common,
        kind: "number",
        whole: inner.type === "integer",
        nullable,
        unit: text(schema.unit ?? inner.unit),
        range: rangeOf(inner),
      };
    default:
      return { ...common, kind: "text" };
  }
}

function rowsOf(schema: Schema, root: Schema, common: Common): Rows {
  const item = resolve((schema.items ?? {}) as Schema, root);
  const row = (index: number) =>
    sectionOf(item, root, {
      path: join(common.path, String(index)),
      title: `${common.title} ${index + 1}`,
      help: "",
    });
  return {
    ...common,
    kind: "rows",
    row,
    least: Number(schema.minItems ?? 0),
    most: Number(schema.maxItems ?? Infinity),
    fresh: defaultOf(item, root),
  };
}

/** A reference followed; words beside it (a default, a description) win. */
function resolve(schema: Schema, root: Schema): Schema {
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

/** What a value can be besides null; the schema itself where null is not allowed. */
function notNull(schema: Schema, root: Schema): Schema {
  if (!Array.isArray(schema.anyOf)) return schema;
  const rest = (schema.anyOf as Schema[]).filter((option) => option.type !== "null");
  if (rest.length === schema.anyOf.length || rest.length !== 1) return schema;
  return resolve(rest[0]!, root);
}

function rangeOf(schema: Schema): Range {
  const { minimum, exclusiveMinimum, maximum, exclusiveMaximum } = schema;
  const low = minimum ?? exclusiveMinimum;
  const high = maximum ?? exclusiveMaximum;
  return {
    ...(typeof low === "number" && { low, lowOpen: minimum === undefined }),
    ...(typeof high === "number" && { high, highOpen: maximum === undefined }),
  };
}

/** The default of a schema; of an object, the defaults of its parts. */
function defaultOf(schema: Schema, root: Schema): Json {
  const full = resolve(schema, root);
  if (full.default !== undefined) return full.default;
  if (Array.isArray(full.enum)) return full.enum[0]!;
  const properties = Object.entries((full.properties ?? {}) as Record<string, Schema>);
  if (properties.length === 0) return null;
  return Object.fromEntries(properties.map(([key, part]) => [key, defaultOf(part, root)]));
}

function join(path: string, key: string): string {
  return path ? `${path}.${key}` : key;
}

function text(value: Json | undefined): string {
  return typeof value === "string" ? value : "";
}
