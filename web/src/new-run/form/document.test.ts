import { describe, expect, it } from "vitest";
import type { Spec } from "../../api/types";
import { schemaErrors, messagesByPath, typed, typedJson, typedList, valueAt, withValue } from "./document";
import { FORM } from "./schema.fixture";

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
    expect(schemaErrors(FORM, withValue(whole, path, value))).toEqual([{ field, message }]);
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
