import { describe, expect, it } from "vitest";
import type { Json } from "../../api/types";
import {
  schemaErrors,
  isOff,
  errorsByPath,
  partOf,
  typed,
  typedJson,
  typedList,
  valueAt,
  withValue,
} from "./document";
import { type Field, formOf } from "./fields";
import { PRESETS } from "./form.fixture";

/** The value after a user has retyped the text that the form shows. */
function retyped(field: Field, value: Json): Json {
  switch (field.kind) {
    case "number":
      return typed(value === null ? "" : String(value));
    case "list":
      return typedList((value as Json[]).join(", "));
    case "nested":
      return typedJson(JSON.stringify(value));
    case "choice":
      return field.options.find((option) => option === value) ?? null;
    case "multiple":
      return field.options.filter((option) => (value as Json[]).includes(option));
    default:
      return value;
  }
}

/** The document that the form writes, field by field. */
function rebuilt(field: Field, document: Json, made: Json): Json {
  const into = (fields: Field[], start: Json) =>
    fields.reduce((changed, each) => rebuilt(each, document, changed), start);
  if (field.kind === "section") {
    if (isOff(field, document)) return withValue(made, field.path, null);
    return into(field.fields, withValue(made, field.path, {}));
  }
  if (field.kind === "union") {
    const part = partOf(field, document);
    if (!part && field.nullable) return withValue(made, field.path, null);
    const tag = `${field.path}.${field.tag}`;
    const start = withValue(withValue(made, field.path, {}), tag, valueAt(document, tag));
    return into(part!.fields, start);
  }
  if (field.kind === "rows") {
    const items = valueAt(document, field.path) as Json[];
    const [empty, rows] = [items.map(() => ({})), items.map((_, i) => field.row(i))];
    return into(rows, withValue(made, field.path, empty));
  }
  return withValue(made, field.path, retyped(field, valueAt(document, field.path)));
}

describe("the form of a preset", () => {
  it.each(PRESETS)("of %s holds every value and changes none", (_, { schema }, { spec }) => {
    const form = formOf(schema);
    expect(rebuilt(form, spec, {})).toEqual(spec);
    expect(schemaErrors(form, spec)).toEqual([]);
  });

  it.each(PRESETS)("of %s shows an error at each of its fields", (_, { schema }, { spec }) => {
    const form = formOf(schema);
    const paths = pathsOf(spec).filter((path) => path !== "experiment");
    for (const path of paths) {
      const [place] = [...errorsByPath([{ field: path, reason: "no" }], form, spec).keys()];
      expect(`${path}.`.startsWith(`${place}.`)).toBe(true);
      expect(place).not.toBe("");
    }
  });
});

function pathsOf(value: Json, path = ""): string[] {
  if (value === null || typeof value !== "object") return [path];
  const inside = Object.entries(value);
  return inside.flatMap(([key, part]) => pathsOf(part, path ? `${path}.${key}` : key));
}
