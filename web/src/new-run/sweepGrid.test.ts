import { describe, expect, it } from "vitest";
import type { Json } from "../api/types";
import { formOf, type Leaf } from "./form/fields";
import { nameOf, readSeeds, readValues, sweepable } from "./sweep";

const FORM = formOf({
  properties: {
    experiment: { const: "x" },
    seed: { type: "integer", default: 0 },
    world: {
      type: "object",
      properties: {
        viscosity: { type: "number", minimum: 0.001, maximum: 2 },
        width: { type: "integer", minimum: 8 },
        limit: { anyOf: [{ type: "number" }, { type: "null" }], default: null },
        fluid: { type: "boolean" },
        magic: { enum: ["capped", "fixed"] },
      },
    },
    targets: { type: "array", items: { type: "number" } },
  },
});

const SPEC = { experiment: "x", seed: 0, world: { viscosity: 0.1, width: 32 }, targets: [1] };

const fields = sweepable(FORM, SPEC);

const field = (path: string): Leaf => fields.find((one) => one.path === path)!;

describe("the fields of a grid", () => {
  it("are all values of the spec except its seed and constants", () => {
    const inside = ["viscosity", "width", "limit", "fluid", "magic"].map((name) => `world.${name}`);
    expect(fields.map(({ path }) => path)).toEqual([...inside, "targets"]);
    expect(nameOf(field("world.viscosity"))).toBe("World: viscosity");
    expect(nameOf(field("targets"))).toBe("Targets");
  });

  it.each<[path: string, text: string, values: Json[]]>([
    ["world.viscosity", "0.05, 0.1,0.2", [0.05, 0.1, 0.2]],
    ["world.viscosity", " 1e-2 ;0.1 ", [0.01, 0.1]],
    ["world.viscosity", "[0.5, 1]", [0.5, 1]],
    ["world.limit", "none, 0.5", [null, 0.5]],
    ["world.fluid", "on off", [true, false]],
    ["world.magic", "capped fixed", ["capped", "fixed"]],
    ["targets", "[[1, 2], [3]]", [[1, 2], [3]]],
  ])("read %s from %j", (path, text, values) => {
    expect(readValues(field(path), text)).toEqual({ values, problem: null });
  });

  it.each([
    ["world.viscosity", "", "Needs values"],
    ["world.viscosity", "0.1, thick", "Needs a number, got “thick”"],
    ["world.viscosity", "0.1, 3", "Needs at most 2"],
    ["world.viscosity", "0.1, 0.10", "0.1 appears more than once"],
    ["world.width", "32, 32.5", "Needs a whole number"],
    ["world.fluid", "on, maybe", "Needs on or off"],
    ["world.magic", "fixd", "Needs one of capped, fixed, got “fixd”"],
    ["world.viscosity", "[0.1", "Needs a JSON list"],
    ["targets", "1, 2", "Needs a JSON list"],
  ])("say what is wrong with %s as %j", (path, text, words) => {
    expect(readValues(field(path), text).problem).toContain(words);
  });

  it.each([
    ["3", 3, true],
    ["1000", 1000, true],
    ["0", 1, false],
    ["1001", 1, false],
    ["2.5", 1, false],
    ["", 1, false],
  ])("read %j as a number of seeds", (text, seeds, right) => {
    const read = readSeeds(text);
    expect([read.seeds, read.problem === null]).toEqual([seeds, right]);
  });
});
