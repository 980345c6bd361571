import { describe, expect, it } from "vitest";
import type { Spec } from "../../api/types";
import { countWithin, changedPaths, equalPreset } from "./document";
import { type NumberField, type Section, formOf } from "./fields";
import { EXPERIMENTS, PRESETS, experiment } from "./presets.fixture";
import { rangeText } from "./Entry";

describe("differences", () => {
  it("are paths of values, and of parts and lists that are made otherwise", () => {
    const a = { seed: 0, body: { builder: "chain", nodes: 3 }, rows: [{ x: 1 }, { x: 2 }], list: [1, 2] };
    expect(changedPaths(a, structuredClone(a))).toEqual([]);
    const b = { seed: 1, body: { builder: "worm" }, rows: [{ x: 1 }, { x: 3 }], list: [1, 3] };
    expect(changedPaths(a, b)).toEqual(["seed", "body", "rows.1.x", "list"]);
    expect(changedPaths({ part: null }, { part: { x: 1 } })).toEqual(["part"]);
    expect(changedPaths({ rows: [] }, { rows: [{ x: 1 }] })).toEqual(["rows"]);
  });

  it("are counted within a part, not within one whose name begins like it", () => {
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
  it("of a number beside the word that decides them, or of the part around it", () => {
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

  it("closes parts that are seldom changed", () => {
    const form = formOf(experiment("quality-diversity").schema);
    const seldom = form.fields.filter((field) => "seldom" in field).map(({ path }) => path);
    expect(seldom).toEqual(["coupling", "genome"]);
  });
});
