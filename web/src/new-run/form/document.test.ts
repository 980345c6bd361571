import { describe, expect, it } from "vitest";
import type { Spec } from "../../api/types";
import {
  changedPaths,
  countWithin,
  equalPreset,
  errorsByPath,
  schemaErrors,
  typed,
  typedJson,
  typedList,
  valueAt,
  withValue,
} from "./document";
import { rangeText } from "./Entry";
import { type NumberField, type Section, formOf } from "./fields";
import { EXPERIMENTS, FORM, PRESETS, experiment } from "./form.fixture";

describe("a spec under a form", () => {
  const spec: Spec = { world: { width: 32 }, axes: [{ bins: 4 }, { bins: 5 }] };

  const at = (...fields: string[]) => {
    const whole = { ...spec, world: { width: 32, steric: null }, body: { builder: "chain" } };
    const errors = fields.map((field) => ({ field, reason: field }));
    const found = errorsByPath(errors, FORM, whole);
    return new Map([...found].map(([path, inside]) => [path, inside.map(({ reason }) => reason)]));
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

  it("reads typed lists; other words stay text", () => {
    expect(typedList(" 0.001, 2;3\n4 ")).toEqual([0.001, 2, 3, 4]);
    expect(typedList("1, x")).toEqual([1, "x"]);
    expect(typedList("")).toEqual([]);
    expect([typedJson("[[0, 1]]"), typedJson("[[0,")]).toEqual([[[0, 1]], "[[0,"]);
  });

  it.each([
    ["world.width", 8, "Needs at least 16."],
    ["world.width", 16.5, "Needs a whole number, got 16.5."],
    ["world.width", null, "Needs a number."],
    ["world.viscosity", 0, "Needs more than 0."],
    ["world.viscosity", 3, "Needs at most 2."],
    ["axes.0.bins", "x", "Needs a number, got “x”."],
    ["viscosities", [], "Needs at least 1 number."],
    ["viscosities", [1, 1, 1, 1], "Needs at most 3 numbers."],
    ["viscosities", [0.5, 3], "Needs at most 2."],
    ["viscosities", [0.5, "x"], "Needs a number, got “x”."],
    ["swimmers", [], "Select at least 1."],
    ["body.nodes", 2, "Needs at least 3."],
    ["world.steric", { strength: 21 }, "Needs at most 20.", "world.steric.strength"],
    [
      "body",
      { builder: "line", points: "[[" },
      "Needs a list of lists, such as [[0, 1], [2, 3]].",
      "body.points",
    ],
  ])("has an error at %s with %j", (path, value, message, field = path) => {
    const whole = {
      world: { width: 32, viscosity: 1, limit: null, steric: null },
      body: { builder: "chain", stretch: 1, nodes: 8 },
      swimmers: ["worm"],
      viscosities: [1],
      axes: [{ bins: 4 }],
    };
    expect(schemaErrors(FORM, whole)).toEqual([]);
    expect(schemaErrors(FORM, withValue(whole, path, value))).toEqual([{ field, reason: message }]);
  });

  it("shows the server's errors at the field they name, in either notation of an index", () => {
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

describe("differences", () => {
  it("are paths of values, and of objects and lists of another shape", () => {
    const a = { seed: 0, body: { builder: "chain", nodes: 3 }, rows: [{ x: 1 }, { x: 2 }], list: [1, 2] };
    expect(changedPaths(a, structuredClone(a))).toEqual([]);
    const b = { seed: 1, body: { builder: "worm" }, rows: [{ x: 1 }, { x: 3 }], list: [1, 3] };
    expect(changedPaths(a, b)).toEqual(["seed", "body", "rows.1.x", "list"]);
    expect(changedPaths({ part: null }, { part: { x: 1 } })).toEqual(["part"]);
    expect(changedPaths({ rows: [] }, { rows: [{ x: 1 }] })).toEqual(["rows"]);
  });

  it("are counted within a part, not within parts with the same prefix", () => {
    expect(countWithin(["world", "world.width", "worldly.x"], "world")).toBe(2);
  });

  it.each(PRESETS)("find %s by its spec, whatever its seed", (_, __, preset) => {
    expect(equalPreset(preset.spec, EXPERIMENTS)?.spec).toEqual(preset.spec);
    const seeded = "seed" in preset.spec ? { ...preset.spec, seed: 99 } : preset.spec;
    expect(equalPreset(seeded, EXPERIMENTS)?.spec).toEqual(preset.spec);
    expect(equalPreset({ ...preset.spec, steps: -1, width: -1 }, EXPERIMENTS)).toBeNull();
  });
});

describe("units and ranges", () => {
  it("of a number depend on a choice beside it, or on the part around it", () => {
    const number = (description: string, more: Spec = {}) => ({ type: "number", description, ...more });
    const form = formOf({
      properties: {
        kind: { type: "string", enum: ["a", "b"] },
        low: number("Low.", { unit_of: "kind", units: { a: "rad", b: "" } }),
        angle: { type: "object", unit: "rad", properties: { high: number("High.") } },
      },
    });
    const [, low, angle] = form.fields as [unknown, NumberField, Section];
    expect(low.unitBy).toEqual({ path: "kind", units: { a: "rad", b: "" } });
    expect(angle.fields[0]).toMatchObject({ path: "angle.high", unit: "rad" });
  });

  it.each([
    [{ low: 16, high: 2048 }, "16 to 2,048"],
    [{ low: 0, lowOpen: true, high: 1 }, "more than 0, at most 1"],
    [{ low: 1, high: 1e6 }, "1 to 1,000,000"],
    [{ low: 1 }, "at least 1"],
    [{}, ""],
  ])("%j is %s", (range, text) => expect(rangeText(range)).toBe(text));

  it("of parts that are seldom changed are closed", () => {
    const form = formOf(experiment("quality-diversity").schema);
    const seldom = form.fields.filter((field) => "seldom" in field).map(({ path }) => path);
    expect(seldom).toEqual(["coupling", "genome"]);
  });
});
