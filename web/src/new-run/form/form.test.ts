import { describe, expect, it } from "vitest";
import type { Schema, Spec } from "../../api/types";
import { changedPaths, errorsByPath, partOf, schemaErrors, valueAt, withChoice } from "./document";
import { type Choice, type Field, type Rows, type Section, type Union, formOf } from "./fields";
import { FORM, experiment } from "./form.fixture";
import { withDefaults } from "./schema";

const part = <F extends Field>(section: Section, path: string) =>
  section.fields.find((field) => field.path === path) as F;

const WORLD = part<Section>(FORM, "world");

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

  it("has a number that may be empty if null is allowed", () => {
    expect(part(WORLD, "world.limit")).toMatchObject({ kind: "number", nullable: true, unit: "m" });
  });

  it("keeps the type of options", () => {
    expect(part(WORLD, "world.factor")).toMatchObject({ kind: "choice", options: [1, 2] });
    expect(part(WORLD, "world.open")).toMatchObject({ kind: "flag" });
    expect(part(FORM, "experiment")).toMatchObject({ kind: "constant" });
  });

  it("has a section that can be switched on with its defaults if null is allowed", () => {
    expect(part(WORLD, "world.steric")).toMatchObject({ kind: "section", initial: { strength: 4 } });
    expect(WORLD.initial).toBeUndefined();
  });

  it("has a part for each name of a union, with its defaults", () => {
    const union = part<Union>(FORM, "body");
    expect([union.tag, ...union.parts.keys()]).toEqual(["builder", "chain", "line", "worm", "ray"]);
    const chain = union.parts.get("chain")!;
    expect(chain.initial).toEqual({ builder: "chain", stretch: 1, nodes: 32 });
    expect(chain.help).toBe("A straight filament.");
    expect(chain.fields.map(({ path }) => path)).toEqual(["body.stretch", "body.nodes"]);
    expect(JSON.stringify(union.parts.get("line")!.initial)).toBe(
      '{"builder":"line","points":[[0,0],[1,1]]}',
    );
    expect(union.parts.get("ray")!.initial).toEqual({ builder: "ray" });
    expect(partOf(union, { body: { builder: "worm" } })).toBe(union.parts.get("worm"));
    expect(partOf(union, { body: { builder: "unheard of" } })).toBeNull();
  });

  it("has a union without a part if null is allowed", () => {
    const archive = part<Section>(formOf(experiment("quality-diversity").schema), "archive");
    const union = part<Union>(archive, "archive.container");
    expect([union.nullable, part<Union>(FORM, "body").nullable]).toEqual([true, false]);
    expect([...union.parts.keys()]).toContain("fronts");
    expect(partOf(union, { archive: { container: null } })).toBeNull();
  });

  it("has lists of numbers and of words for arrays of them", () => {
    expect(part(FORM, "swimmers")).toMatchObject({ kind: "multiple", options: ["worm", "ray"] });
    expect(part(FORM, "viscosities")).toMatchObject({ kind: "list", minItems: 1, maxItems: 3 });
  });

  it("has rows for arrays of objects, and an initial row from their defaults", () => {
    const rows = part<Rows>(FORM, "axes");
    const initial = { name: "a", bins: 20, low: null, scale: null };
    expect([rows.minItems, rows.maxItems, rows.initial]).toEqual([1, 2, initial]);
    const row = rows.row(1) as Section;
    const names = ["name", "bins", "low", "scale"];
    expect(row.fields.map(({ path }) => path)).toEqual(names.map((name) => `axes.1.${name}`));
  });

  it("clears values that follow from a choice when the choice changes", () => {
    const rows = part<Rows>(FORM, "axes");
    const row = rows.row(0) as Section;
    const [name, bins, low, scale] = row.fields as [Field, Field, Field, Field];
    expect(row.following).toEqual(["low", "scale"]);
    expect([bins, low, scale]).toMatchObject([{ nullable: false }, { nullable: true }, { nullable: true }]);
    const spec = { axes: [{ name: "a", bins: 4, low: -1, scale: "linear" }] };
    const selected = withChoice(spec, row, name, "b");
    expect(selected).toEqual({ axes: [{ name: "b", bins: 4, low: null, scale: null }] });
    expect(valueAt(withChoice(spec, row, scale, "log10"), "axes.0.low")).toBe(-1);
    expect(valueAt(withChoice(spec, row, bins, 9), "axes.0.low")).toBe(-1);
  });

  it("has rows of parts for arrays of a union, each row of its own kind", () => {
    const rows = part<Rows>(FORM, "emitters");
    expect(rows.initial).toEqual({ operator: "any" });
    const row = rows.row(2) as Union;
    expect([row.path, row.tag]).toEqual(["emitters.2", "operator"]);
    const selected = row.parts.get("line")!;
    expect(selected.initial).toEqual({ operator: "line", step: 0.5 });
    expect(selected.fields.map(({ path }) => path)).toEqual(["emitters.2.step"]);
    const spec: Spec = { emitters: [{ operator: "any" }, { operator: "line", step: 0 }] };
    const wrong = schemaErrors(FORM, spec).filter(({ field }) => field.startsWith("emitters"));
    expect(wrong).toEqual([{ field: "emitters.1.step", reason: "Needs more than 0." }]);
    const error = { field: "emitters.1.step", reason: "no" };
    expect([...errorsByPath([error], FORM, spec).keys()]).toEqual(["emitters.1.step"]);
  });
});

const settings: Schema = {
  type: "object",
  inline: true,
  properties: { strictness: { type: "number", default: 1, minimum: 0, maximum: 10 } },
};
const plugin: Schema = {
  type: "object",
  inline: true,
  default: { settings: { strictness: 1 } },
  properties: { settings },
};
const about = { title: "Straight way", about: "How far.", workers: ["gpu-1"] };
const PLUGINS: Schema = {
  type: "object",
  properties: {
    body: {
      default: { builder: "chain" },
      oneOf: [
        { type: "object", properties: { builder: { const: "chain", default: "chain" } } },
        { type: "object", properties: { builder: { const: "mine.cross" }, plugin } },
      ],
    },
    task: {
      type: "object",
      properties: {
        fitness: {
          default: "displacement",
          enum: ["displacement", "mine.straight"],
          plugins: { "mine.straight": about },
        },
        plugin: { settings_of: "fitness", parts: { "mine.straight": plugin } },
      },
    },
  },
};
const SPEC: Spec = { body: { builder: "chain" }, task: { fitness: "displacement" } };
const form = formOf(PLUGINS);
const task = form.fields.find(({ path }) => path === "task") as Section;
const fitness = task.fields.find(({ path }) => path === "task.fitness") as Choice;

describe("a choice with plug-ins", () => {
  it("has its title and its workers", () => {
    expect(fitness.options).toContain("mine.straight");
    expect(fitness.plugins?.["mine.straight"]).toEqual(about);
  });

  it("adds its settings when it is selected, and removes them afterwards", () => {
    const selected = withChoice(SPEC, task, fitness, "mine.straight");
    expect(valueAt(selected, "task.plugin.settings.strictness")).toBe(1);
    const left = withChoice(selected, task, fitness, "displacement");
    expect(valueAt(left, "task.plugin")).toBeNull();
    expect(changedPaths(selected, SPEC)).toEqual(["task.fitness", "task.plugin"]);
    expect(changedPaths(left, SPEC)).toEqual([]);
  });

  it("has its settings checked only while it is selected", () => {
    const wrong = { fitness: "mine.straight", plugin: { settings: { strictness: 11 } } };
    expect(schemaErrors(form, { ...SPEC, task: wrong })).toEqual([
      { field: "task.plugin.settings.strictness", reason: "Needs at most 10." },
    ]);
    expect(schemaErrors(form, { ...SPEC, task: { ...wrong, fitness: "displacement" } })).toEqual([]);
  });
});

describe("a body from a plug-in", () => {
  it("has its settings as fields, with their defaults", () => {
    const body = form.fields.find(({ path }) => path === "body");
    const cross = body?.kind === "union" ? body.parts.get("mine.cross") : undefined;
    expect(cross?.fields.map(({ path }) => path)).toEqual(["body.plugin.settings.strictness"]);
    expect(cross?.initial).toEqual({ builder: "mine.cross", plugin: { settings: { strictness: 1 } } });
  });
});

describe("a spec of another run", () => {
  const version = { source: "a".repeat(64), title: "T", sizes: {}, settings: { strictness: 3 } };

  it("gets the current version of a plug-in, and keeps its settings", () => {
    const spec = { ...SPEC, task: { fitness: "mine.straight", plugin: version } };
    expect(withDefaults(PLUGINS, spec).task).toEqual({
      fitness: "mine.straight",
      plugin: { settings: { strictness: 3 } },
    });
  });

  it("leaves a creature unchanged", () => {
    const creature = { identity: { task: { plugin: version } } };
    expect(withDefaults(PLUGINS, { ...SPEC, creature }).creature).toEqual(creature);
  });
});
