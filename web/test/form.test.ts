import { describe, expect, it } from "vitest";
import type { Schema, Spec } from "../src/api/types";
import { complaints, messagesByPath, typed, valueAt, withValue } from "../src/view/form/document";
import { type Field, type Section, formOf } from "../src/view/form/fields";

const SCHEMA: Schema = {
  description: "A run.",
  $defs: {
    World: {
      type: "object",
      description: "A box of fluid.",
      properties: {
        width: { type: "integer", minimum: 16, maximum: 2048, unit: "cells", description: "Along x." },
        viscosity: { type: "number", exclusiveMinimum: 0, maximum: 2 },
        limit: { anyOf: [{ type: "number", minimum: 0 }, { type: "null" }], default: null, unit: "m" },
        magic: { type: "string", enum: ["capped", "fixed"] },
        factor: { type: "integer", enum: [1, 2] },
        open: { type: "boolean" },
      },
    },
    Axis: {
      type: "object",
      properties: { name: { enum: ["a", "b"] }, bins: { type: "integer", default: 20 } },
    },
  },
  properties: {
    experiment: { const: "quality-diversity", type: "string" },
    world: { $ref: "#/$defs/World", default: {} },
    axes: { type: "array", items: { $ref: "#/$defs/Axis" }, minItems: 1, maxItems: 2 },
  },
};

const FORM = formOf(SCHEMA);
const part = (section: Section, path: string) =>
  section.fields.find((field) => field.path === path) as Field;
const WORLD = part(FORM, "world") as Section;

describe("a form", () => {
  it("has a section for a referenced object, with its own help", () => {
    expect(WORLD).toMatchObject({ kind: "section", title: "World", help: "A box of fluid." });
  });

  it("has numbers with unit, range and help", () => {
    expect(part(WORLD, "world.width")).toEqual({
      kind: "number",
      path: "world.width",
      title: "Width",
      help: "Along x.",
      whole: true,
      nullable: false,
      unit: "cells",
      range: { low: 16, lowOpen: false, high: 2048, highOpen: false },
    });
    expect(part(WORLD, "world.viscosity")).toMatchObject({ range: { low: 0, lowOpen: true } });
  });

  it("has a number that may be left empty where null is allowed", () => {
    expect(part(WORLD, "world.limit")).toMatchObject({ kind: "number", nullable: true, unit: "m" });
  });

  it("keeps the type of what can be chosen", () => {
    expect(part(WORLD, "world.factor")).toMatchObject({ kind: "choice", options: [1, 2] });
    expect(part(WORLD, "world.open")).toMatchObject({ kind: "flag" });
    expect(part(FORM, "experiment")).toMatchObject({ kind: "constant" });
  });

  it("has rows for arrays of objects, and a fresh row from their defaults", () => {
    const rows = part(FORM, "axes");
    if (rows.kind !== "rows") throw new Error(rows.kind);
    expect([rows.least, rows.most, rows.fresh]).toEqual([1, 2, { name: "a", bins: 20 }]);
    expect(rows.row(1).fields.map(({ path }) => path)).toEqual(["axes.1.name", "axes.1.bins"]);
  });
});

describe("a spec under a form", () => {
  const spec: Spec = { world: { width: 32 }, axes: [{ bins: 4 }, { bins: 5 }] };

  it("is changed by path, and never in place", () => {
    const next = withValue(spec, "axes.1.bins", 9);
    expect(valueAt(next, "axes.1.bins")).toBe(9);
    expect(valueAt(spec, "axes.1.bins")).toBe(5);
    expect(valueAt(next, "world")).toBe(spec.world);
  });

  it.each([
    ["", null],
    ["1e-3", 0.001],
    ["−2", -2],
    ["1e", "1e"],
    ["abc", "abc"],
  ])("takes %j as %j", (text, value) => {
    expect(typed(text)).toBe(value);
  });

  it.each([
    ["world.width", 8, "Needs at least 16."],
    ["world.width", 16.5, "Needs a whole number, got 16.5."],
    ["world.width", null, "Needs a number."],
    ["world.viscosity", 0, "Needs more than 0."],
    ["world.viscosity", 3, "Needs at most 2."],
    ["axes.0.bins", "x", "Needs a number, got “x”."],
  ])("is told what is wrong at %s with %j", (path, value, message) => {
    const whole = { world: { width: 32, viscosity: 1, limit: null }, axes: [{ bins: 4 }] };
    expect(complaints(FORM, whole)).toEqual([]);
    expect(complaints(FORM, withValue(whole, path, value))).toEqual([{ field: path, message }]);
  });

  it("shows the server's errors at the field they name, however the place is written", () => {
    const messages = messagesByPath([
      { field: "archive.descriptors[0].low", message: "one" },
      { field: "archive.descriptors.0.low", message: "two" },
    ]);
    expect(messages.get("archive.descriptors.0.low")).toEqual(["one", "two"]);
  });
});
