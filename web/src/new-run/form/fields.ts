/** The fields of a form, read from a JSON schema. */

import type { Json, Schema, Spec } from "../../api/types";
import { words } from "../../ui/format";
import { type Range, defaultOf, join, notNull, rangeOf, resolve, tagOf, text } from "./schema";

export type { Range };

interface Common {
  /** Path of the value in the spec: `world.viscosity`, `archive.descriptors.0.low`. */
  path: string;
  title: string;
  help: string;
  /** The choice that shows the field: settings belong to one plug-in. */
  when?: { path: string; is: string };
}

interface PluginOption {
  title: string;
  about: string;
  workers: string[];
}

export interface Section extends Common {
  kind: "section";
  fields: Field[];
  /** Names of fields whose missing values follow from other fields. */
  following: string[];
  /** The settings of each plug-in of a choice when it is selected. */
  settings?: { path: string; initial: Record<string, Json> };
  /** The first value after switching it on; undefined if it cannot be switched off. */
  initial?: Json;
  /** True if its values are seldom changed. */
  seldom?: boolean;
}

/** A choice between several parts; the value at `tag` names the selected one. */
export interface Union extends Common {
  kind: "union";
  tag: string;
  /** True if no part can be selected. */
  nullable: boolean;
  parts: ReadonlyMap<string, Section>;
}

export interface Rows extends Common {
  kind: "rows";
  row: (index: number) => Section | Union;
  minItems: number;
  maxItems: number;
  initial: Json;
}

export interface NumberField extends Common {
  kind: "number";
  whole: boolean;
  nullable: boolean;
  unit: string;
  /** The value that decides the unit, by its path, and the unit for each value. */
  unitBy?: { path: string; units: Record<string, string> };
  range: Range;
}

export interface Choice extends Common {
  kind: "choice";
  nullable: boolean;
  options: Json[];
  plugins?: Record<string, PluginOption>;
}

export interface List extends Common {
  kind: "list";
  item: NumberField;
  minItems: number;
  maxItems: number;
}

export interface Multiple extends Common {
  kind: "multiple";
  options: Json[];
  minItems: number;
}

/** `nested` is a list of lists, which is typed as JSON. */
interface Plain extends Common {
  kind: "nested" | "flag" | "text";
}

interface Constant extends Common {
  kind: "constant";
}

export type Leaf = NumberField | Choice | List | Multiple | Plain;
export type Field = Section | Union | Rows | Constant | Leaf;

export function formOf(schema: Schema): Section {
  return sectionOf(schema, schema, { path: "", title: "", help: text(schema.description) });
}

function sectionOf(schema: Schema, root: Schema, common: Common): Section {
  const properties = (schema.properties ?? {}) as Record<string, Schema>;
  const following = followingOf(schema, root);
  const fields = Object.entries(properties).flatMap(([key, property]) => {
    const path = join(common.path, key);
    if (property.parts) return settingsOf(property, root, common.path, path);
    // The unit of a part is that of all fields in it.
    const unit: Schema = schema.unit === undefined ? {} : { unit: schema.unit };
    const field = fieldOf({ ...unit, ...property }, root, key, path, following.includes(key));
    return property.inline === true ? (field as Section).fields : [field];
  });
  const seldom = schema.seldom === true && { seldom: true };
  return { ...common, kind: "section", fields, following, ...seldom, ...pluginSettings(schema, common.path) };
}

/** The settings of the plug-ins of a choice, each shown with its plug-in. */
function settingsOf(property: Schema, root: Schema, beside: string, path: string): Field[] {
  const choice = join(beside, String(property.settings_of));
  return Object.entries(property.parts as Record<string, Schema>).flatMap(([is, part]) =>
    sectionOf(part, root, { path, title: "", help: "" }).fields.map((field) => ({
      ...field,
      when: { path: choice, is },
    })),
  );
}

function pluginSettings(schema: Schema, path: string): Pick<Section, "settings"> {
  const plugin = (schema.properties as Record<string, Schema> | undefined)?.plugin;
  if (!plugin?.parts) return {};
  const parts = Object.entries(plugin.parts as Record<string, Schema>);
  const initial = Object.fromEntries(parts.map(([name, part]) => [name, part.default!]));
  return { settings: { path: join(path, String(plugin.settings_of)), initial } };
}

/** Names of optional fields without a default. */
function followingOf(schema: Schema, root: Schema): string[] {
  const required = (schema.required ?? []) as string[];
  const properties = Object.entries((schema.properties ?? {}) as Record<string, Schema>);
  return properties
    .filter(([key, part]) => !required.includes(key) && !("default" in resolve(part, root)))
    .map(([key]) => key);
}

function fieldOf(property: Schema, root: Schema, key: string, path: string, follows: boolean): Field {
  const schema = resolve(property, root);
  const inner = notNull(schema, root);
  const nullable = inner !== schema || follows;
  const common = { path, title: words(key), help: text(schema.description) };
  if (Array.isArray(inner.oneOf)) return unionOf(inner, root, { ...common, nullable: inner !== schema });
  if ("const" in inner) return { ...common, kind: "constant" };
  if (Array.isArray(inner.enum)) {
    const plugins = inner.plugins && { plugins: inner.plugins as unknown as Record<string, PluginOption> };
    return { ...common, kind: "choice", nullable, options: inner.enum, ...plugins };
  }
  switch (inner.type) {
    case "object": {
      const section = sectionOf({ ...inner, unit: schema.unit ?? inner.unit! }, root, common);
      if (inner === schema) return section;
      return { ...section, initial: schema.default ?? defaultOf(inner, root) };
    }
    case "array":
      return arrayOf(inner, root, common);
    case "boolean":
      return { ...common, kind: "flag" };
    case "integer":
    case "number":
      return numberOf({ ...inner, ...schema }, inner.type, { ...common, nullable });
    default:
      return { ...common, kind: "text" };
  }
}

function numberOf(schema: Schema, type: Json, common: Common & { nullable: boolean }): NumberField {
  const { unit, unit_of, units } = schema;
  const around = common.path.split(".").slice(0, -1).join(".");
  const unitBy = { path: join(around, String(unit_of)), units: units as Record<string, string> };
  return {
    ...common,
    kind: "number",
    whole: type === "integer",
    unit: text(unit),
    ...(typeof unit_of === "string" && { unitBy }),
    range: rangeOf(schema),
  };
}

function arrayOf(schema: Schema, root: Schema, common: Common): Field {
  const item = resolve((schema.items ?? {}) as Schema, root);
  const [minItems, maxItems] = [Number(schema.minItems ?? 0), Number(schema.maxItems ?? Infinity)];
  if (Array.isArray(item.enum)) return { ...common, kind: "multiple", options: item.enum, minItems };
  if (item.type === "array") return { ...common, kind: "nested" };
  if (item.type !== "integer" && item.type !== "number") return rowsOf(schema, root, common);
  return {
    ...common,
    kind: "list",
    item: numberOf(item, item.type, { ...common, nullable: false }),
    minItems,
    maxItems,
  };
}

/** The names of a part are the constant or the options of its tag. */
function unionOf(
  schema: Schema,
  root: Schema,
  { nullable, ...common }: Common & { nullable: boolean },
): Union {
  const parts = (schema.oneOf as Schema[]).map((part) => resolve(part, root));
  const tag = tagOf(parts);
  const named = parts.flatMap((part) => {
    const { [tag]: names, ...properties } = part.properties as Record<string, Schema>;
    const rest = { ...part, properties };
    return ((names!.enum ?? [names!.const]) as string[]).map((name): [string, Section] => {
      const initial = { [tag]: name, ...(defaultOf(rest, root) as Spec | null) };
      return [name, { ...sectionOf(rest, root, common), help: text(part.description), initial }];
    });
  });
  return { ...common, kind: "union", tag, nullable, parts: new Map(named) };
}

function rowsOf(schema: Schema, root: Schema, common: Common): Rows {
  const item = resolve((schema.items ?? {}) as Schema, root);
  const row = (index: number) => {
    const path = join(common.path, String(index));
    const known = { path, title: `${common.title} ${index + 1}`, help: "" };
    return Array.isArray(item.oneOf)
      ? unionOf(item, root, { ...known, nullable: false })
      : sectionOf(item, root, known);
  };
  const first = row(0);
  return {
    ...common,
    kind: "rows",
    row,
    minItems: Number(schema.minItems ?? 0),
    maxItems: Number(schema.maxItems ?? Infinity),
    initial: first.kind === "union" ? [...first.parts.values()][0]!.initial! : initialOf(item, root, first),
  };
}

function initialOf(item: Schema, root: Schema, { following }: Section): Json {
  const empty = Object.fromEntries(following.map((name) => [name, null]));
  return { ...(defaultOf(item, root) as Spec | null), ...empty };
}
