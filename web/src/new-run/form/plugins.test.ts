/** Plug-ins in forms: choices, and settings that come and go with them. */

import { describe, expect, it } from "vitest";
import type { Schema, Spec } from "../../api/types";
import { completed } from "./defaults";
import { changedPaths, schemaErrors, valueAt, withChoice } from "./document";
import { type Choice, type Section, formOf } from "./fields";

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
const SCHEMA: Schema = {
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
const form = formOf(SCHEMA);
const task = form.fields.find(({ path }) => path === "task") as Section;
const fitness = task.fields.find(({ path }) => path === "task.fitness") as Choice;

describe("a choice with plug-ins", () => {
  it("tells its title and who has it", () => {
    expect(fitness.options).toContain("mine.straight");
    expect(fitness.plugins?.["mine.straight"]).toEqual(about);
  });

  it("brings its settings with it, and takes them away again", () => {
    const selected = withChoice(SPEC, task, fitness, "mine.straight");
    expect(valueAt(selected, "task.plugin.settings.strictness")).toBe(1);
    const left = withChoice(selected, task, fitness, "displacement");
    expect(valueAt(left, "task.plugin")).toBeNull();
    expect(changedPaths(selected, SPEC)).toEqual(["task.fitness", "task.plugin"]);
    expect(changedPaths(left, SPEC)).toEqual([]);
  });

  it("has its settings checked where it is selected, and only there", () => {
    const wrong = { fitness: "mine.straight", plugin: { settings: { strictness: 11 } } };
    expect(schemaErrors(form, { ...SPEC, task: wrong })).toEqual([
      { field: "task.plugin.settings.strictness", message: "Needs at most 10." },
    ]);
    expect(schemaErrors(form, { ...SPEC, task: { ...wrong, fitness: "displacement" } })).toEqual([]);
  });
});

describe("a body from a plug-in", () => {
  it("has its settings as fields, and begins with their defaults", () => {
    const body = form.fields.find(({ path }) => path === "body");
    const cross = body?.kind === "union" ? body.parts.get("mine.cross") : undefined;
    expect(cross?.fields.map(({ path }) => path)).toEqual(["body.plugin.settings.strictness"]);
    expect(cross?.fresh).toEqual({ builder: "mine.cross", plugin: { settings: { strictness: 1 } } });
  });
});

describe("a spec of another run", () => {
  const version = { source: "a".repeat(64), title: "T", sizes: {}, settings: { strictness: 3 } };

  it("takes the version that there is now, with its settings", () => {
    const spec = { ...SPEC, task: { fitness: "mine.straight", plugin: version } };
    expect(completed(SCHEMA, spec).task).toEqual({
      fitness: "mine.straight",
      plugin: { settings: { strictness: 3 } },
    });
  });

  it("leaves a creature what it is", () => {
    const creature = { identity: { task: { plugin: version } } };
    expect(completed(SCHEMA, { ...SPEC, creature }).creature).toEqual(creature);
  });
});
