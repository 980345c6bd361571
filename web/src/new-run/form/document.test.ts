import { describe, expect, it } from "vitest";
import type { Schema, Spec } from "../../api/types";
import { complaints, messagesByPath, typed, typedJson, typedList, valueAt, withValue } from "./document";
import { formOf } from "./fields";

const SCHEMA: Schema = {
  description: "A run.",
  $defs: {
    World: {
      type: "object",
      description: "A box of fluid.",
      required: ["width", "viscosity", "magic", "factor", "open"],
      properties: {
        width: { type: "integer", minimum: 16, maximum: 2048, unit: "cells", description: "Along x." },
        viscosity: { type: "number", exclusiveMinimum: 0, maximum: 2 },
        limit: { anyOf: [{ type: "number", minimum: 0 }, { type: "null" }], default: null, unit: "m" },
        magic: { type: "string", enum: ["capped", "fixed"] },
        factor: { type: "integer", enum: [1, 2] },
        open: { type: "boolean" },
        steric: { anyOf: [{ $ref: "#/$defs/Steric" }, { type: "null" }], default: null },
      },
    },
    Steric: {
      type: "object",
      properties: { strength: { type: "number", default: 4, maximum: 20 } },
    },
    Chain: {
      type: "object",
      description: "A straight filament.",
      properties: {
        stretch: { type: "number", default: 1 },
        builder: { const: "chain", default: "chain", type: "string" },
        nodes: { type: "integer", default: 32, minimum: 3 },
      },
    },
    Line: {
      type: "object",
      properties: {
        builder: { const: "line", type: "string" },
        points: {
          type: "array",
          minItems: 2,
          items: { type: "array", prefixItems: [{ type: "number" }, { type: "number" }] },
        },
      },
    },
    Known: {
      type: "object",
      properties: { builder: { enum: ["worm", "ray"], type: "string" } },
    },
    Axis: {
      type: "object",
      required: ["name"],
      properties: {
        name: { enum: ["a", "b"] },
        bins: { type: "integer", default: 20 },
        low: { type: "number", minimum: -5 },
        scale: { enum: ["log10", "linear"], type: "string" },
      },
    },
    Line2: {
      type: "object",
      properties: {
        operator: { const: "line", default: "line", type: "string" },
        step: { type: "number", default: 0.5, exclusiveMinimum: 0 },
      },
    },
    Any: {
      type: "object",
      properties: { operator: { const: "any", default: "any", type: "string" } },
    },
  },
  properties: {
    experiment: { const: "quality-diversity", type: "string" },
    world: { $ref: "#/$defs/World", default: {} },
    body: {
      oneOf: [{ $ref: "#/$defs/Chain" }, { $ref: "#/$defs/Line" }, { $ref: "#/$defs/Known" }],
    },
    swimmers: { type: "array", items: { enum: ["worm", "ray"], type: "string" }, minItems: 1 },
    viscosities: {
      type: "array",
      items: { type: "number", minimum: 0.001, maximum: 2 },
      minItems: 1,
      maxItems: 3,
    },
    axes: { type: "array", items: { $ref: "#/$defs/Axis" }, minItems: 1, maxItems: 2 },
    emitters: {
      type: "array",
      default: [],
      items: { oneOf: [{ $ref: "#/$defs/Any" }, { $ref: "#/$defs/Line2" }] },
      minItems: 1,
      maxItems: 3,
    },
  },
};

const FORM = formOf(SCHEMA);

describe("a spec under a form", () => {
  const spec: Spec = { world: { width: 32 }, axes: [{ bins: 4 }, { bins: 5 }] };

  const at = (...fields: string[]) => {
    const whole = { ...spec, world: { width: 32, steric: null }, body: { builder: "chain" } };
    return messagesByPath(
      fields.map((field) => ({ field, message: field })),
      FORM,
      whole,
    );
  };

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

  it("has lists as they are typed, and what is no number stays text", () => {
    expect(typedList(" 0.001, 2;3\n4 ")).toEqual([0.001, 2, 3, 4]);
    expect(typedList("1, x")).toEqual([1, "x"]);
    expect(typedList("")).toEqual([]);
    expect([typedJson("[[0, 1]]"), typedJson("[[0,")]).toEqual([[[0, 1]], "[[0,"]);
  });

  it.each([
    ["viscosities", [], "Needs at least 1 number."],
    ["viscosities", [1, 1, 1, 1], "Needs at most 3 numbers."],
    ["viscosities", [0.5, 3], "Needs at most 2."],
    ["viscosities", [0.5, "x"], "Needs a number, got “x”."],
    ["swimmers", [], "Select at least 1."],
    ["body.nodes", 2, "Needs at least 3."],
    ["world.steric", { strength: 21 }, "Needs at most 20."],
    ["body", { builder: "line", points: "[[" }, "Needs a list of lists, such as [[0, 1], [2, 3]]."],
  ])("is told what is wrong with parts and lists at %s with %j", (path, value, message) => {
    const whole = {
      world: { width: 32, viscosity: 1, limit: null, steric: null },
      body: { builder: "chain", stretch: 1, nodes: 8 },
      swimmers: ["worm"],
      viscosities: [1],
      axes: [],
    };
    expect(complaints(FORM, whole)).toEqual([]);
    expect(complaints(FORM, withValue(whole, path, value)).map((one) => one.message)).toEqual([message]);
  });

  it.each([
    ["world.width", 8, "Needs at least 16."],
    ["world.width", 16.5, "Needs a whole number, got 16.5."],
    ["world.width", null, "Needs a number."],
    ["world.viscosity", 0, "Needs more than 0."],
    ["world.viscosity", 3, "Needs at most 2."],
    ["axes.0.bins", "x", "Needs a number, got “x”."],
  ])("is told what is wrong at %s with %j", (path, value, message) => {
    const whole = {
      world: { width: 32, viscosity: 1, limit: null },
      body: { builder: "worm" },
      swimmers: ["worm"],
      viscosities: [1],
      axes: [{ bins: 4 }],
    };
    expect(complaints(FORM, whole)).toEqual([]);
    expect(complaints(FORM, withValue(whole, path, value))).toEqual([{ field: path, message }]);
  });

  it("shows the server's errors at the field they name, however the place is written", () => {
    const messages = at("axes[0].bins", "axes.0.bins");
    expect(messages.get("axes.0.bins")).toEqual(["axes[0].bins", "axes.0.bins"]);
    expect([...at("body.nodes")]).toEqual([["body.nodes", ["body.nodes"]]]);
  });

  it.each([
    ["viscosities.2", "viscosities"],
    ["body.positions", "body"],
    ["body.builder", "body"],
    ["axes.7.bins", "axes"],
    ["world.steric.strength", "world.steric"],
    ["nobody.knows", ""],
    ["experiment", ""],
    ["", ""],
  ])("shows an error at %j, which has no field, at %j", (field, place) => {
    expect([...at(field).keys()]).toEqual([place]);
  });
});
