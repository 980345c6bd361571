import { describe, expect, it } from "vitest";
import type { Json, Schema } from "../../api/types";
import { essentialsOf, mendOf, searched } from "./essentials";
import { type Leaf, formOf } from "./fields";
import { partsOf } from "./SpecForm";
import { nameOf } from "../editorState";

const number = (low: number, high: number, description = "") => ({
  type: "number",
  minimum: low,
  maximum: high,
  description,
});
const part = (properties: Record<string, unknown>) => ({ type: "object", properties });
const schema = part({
  seed: { type: "integer", minimum: 0, maximum: 99, description: "Random seed." },
  world: part({ viscosity: number(0.001, 2, "Kinematic viscosity"), width: number(16, 2048, "Box") }),
  search: part({ generations: { type: "integer", minimum: 1, maximum: 1000 } }),
  task: part({ fitness: { enum: ["speed", "energy"] }, steps: number(10, 100) }),
}) as unknown as Schema;
const form = formOf(schema);
const document = {
  seed: 1,
  world: { viscosity: 0.1, width: 48 },
  search: { generations: 30 },
  task: { fitness: "speed", steps: 20 },
} as Json;

describe("the essentials", () => {
  it("are the settings that most people change, in one order, with titles that stand alone", () => {
    const found = essentialsOf(form, document);
    expect(found.map(({ path }) => path)).toEqual([
      "world.viscosity",
      "task.fitness",
      "search.generations",
      "seed",
    ]);
    expect(found[0]!.title).toBe("Viscosity");
  });

  it("are none where a spec has hardly any of them: it is shown whole", () => {
    expect(
      essentialsOf(formOf(part({ seed: { type: "integer" } }) as unknown as Schema), { seed: 0 }),
    ).toEqual([]);
  });
});

describe("the search among settings", () => {
  const titles = (words: string) =>
    searched(partsOf(form), words).map(({ title, ...part }) => [
      title,
      "fields" in part ? part.fields.map((field) => field.title) : [],
    ]);

  it("finds words in titles, paths and explanations", () => {
    expect(titles("kinematic")).toEqual([["World", ["Viscosity"]]]);
    expect(titles("world width")).toEqual([["World", ["Width"]]]);
    expect(titles("random SEED")).toEqual([["General", ["Seed"]]]);
    expect(titles("task")).toEqual([["Task", ["Fitness", "Steps"]]]);
  });

  it("finds nothing that is not there, and everything without words", () => {
    expect(titles("nonsense")).toEqual([]);
    expect(titles("  ")).toHaveLength(4);
  });
});

describe("the mend of a wrong value", () => {
  const leaf = (path: string) => essentialsOf(form, document).find((field) => field.path === path) as Leaf;

  it("is the nearest permitted one", () => {
    expect(mendOf(leaf("world.viscosity"), 5, [])).toBe(2);
    expect(mendOf(leaf("world.viscosity"), 0, [])).toBe(0.001);
    expect(mendOf(leaf("search.generations"), 2.6, [])).toBe(3);
    expect(mendOf(leaf("search.generations"), -4, [])).toBe(1);
  });

  it("is the bound that an error of the server has as data, whatever its words say", () => {
    const error = (bound: object) => [
      { field: "search.generations", reason: "must be at least 5", ...bound },
    ];
    expect(mendOf(leaf("search.generations"), 30, error({ least: 1069 }))).toBe(1069);
    expect(mendOf(leaf("search.generations"), 30, error({}))).toBe(null);
    expect(mendOf(leaf("search.generations"), 30, error({ least: null, most: null }))).toBe(null);
    expect(mendOf(leaf("world.viscosity"), 0.5, error({ least: 1e-3 }))).toBe(0.001);
  });

  it("is whole where a whole number is needed", () => {
    const error = (bound: object) => [{ field: "search.generations", reason: "is wrong", ...bound }];
    expect(mendOf(leaf("search.generations"), 30, error({ least: 77.46 }))).toBe(78);
    expect(mendOf(leaf("search.generations"), 300, error({ most: 77.46 }))).toBe(77);
  });

  it("is none for a right value, or for what is no number", () => {
    expect(mendOf(leaf("world.viscosity"), 0.5, [])).toBe(null);
    expect(mendOf(leaf("world.viscosity"), "thick", [])).toBe(null);
    expect(mendOf(leaf("task.fitness"), "height", [])).toBe(null);
  });
});

describe("the name of a run", () => {
  it("tells the source and what was changed, three things at most", () => {
    const changed = new Set(["world.viscosity", "task.fitness", "search.generations", "seed"]);
    expect(nameOf("quality-diversity/demo", document, form, changed)).toBe(
      "Demo, seed 1, viscosity 0.1, generations 30",
    );
    expect(nameOf("quality-diversity/demo", document, form, new Set(["world.width"]))).toBe("Demo, width 48");
  });

  it("tells an unusual experiment too", () => {
    const name = nameOf("neuroevolution/demo", document, form, new Set(["world.width"]));
    expect(name).toBe("Neuroevolution demo, width 48");
  });

  it("is none without changes, and names no id", () => {
    expect(nameOf("quality-diversity/demo", document, form, new Set())).toBe(null);
    const run = "d78e24de-4b1a-47ec-987f-756f3074c40c";
    expect(nameOf(run, document, form, new Set(["world.width"]))).toBe("width 48");
  });
});
