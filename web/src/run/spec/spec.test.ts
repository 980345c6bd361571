import { describe, expect, it } from "vitest";
import type { Preset } from "../../api/types";
import { differences, groupsOf, valueText } from "./difference";
import { brief, nameOf, nearestPreset, sectionsOf } from "./SpecCard";

describe("the sections of a spec", () => {
  const spec = { seed: 7, search: { batch: 64, stop: null }, axes: [{ name: "a" }], world: { width: 32 } };
  const preset = (name: string, other: object): Preset => ({
    name,
    title: name,
    spec: { ...spec, seed: 0, ...other },
  });
  const presets = [
    preset("far", { axes: [], search: {} }),
    preset("near", { search: { batch: 16, stop: null } }),
  ];

  it("names the nearest preset, whatever the seed", () => {
    const found = nearestPreset(spec, presets)!;
    expect(found.preset.name).toBe("near");
    expect(found.changed.map(({ path }) => path)).toEqual(["search.batch"]);
    expect(nearestPreset(spec, [])).toBeNull();
  });

  it("has one for each part, with the preset's value of each changed field", () => {
    const sections = sectionsOf(spec, nearestPreset(spec, presets)!.changed);
    expect(sections.map(({ title }) => title)).toEqual(["Run", "Search", "Axes", "World"]);
    const [batch, stop] = sections[1]!.fields;
    expect(batch).toEqual({ path: "search.batch", name: "Batch", text: "64", presetValue: "16" });
    expect(stop!.presetValue).toBeNull();
    expect(sections[2]!.fields[0]!.name).toBe("1, name");
  });

  it("names fields by words and cuts what is long", () => {
    expect(nameOf(["descriptors", "0", "bins"])).toBe("Descriptors 1, bins");
    expect(brief("x".repeat(500)).length).toBeLessThan(130);
  });
});

describe("the difference between specs", () => {
  const one = { seed: 0, search: { batch: 16, stop: null }, axes: [{ name: "a", bins: 8 }], tiles: [1, 2] };

  it("is none where they are the same, in whatever order", () => {
    const { seed, ...rest } = one;
    expect(differences([one, { ...rest, seed }])).toEqual([]);
    expect(differences([one])).toEqual([]);
  });

  it("names the path and both values, down to items of lists", () => {
    const other = { ...one, seed: 7, search: { batch: 32, stop: null }, axes: [{ name: "a", bins: 9 }] };
    expect(differences([one, other])).toEqual([
      { path: "seed", values: [0, 7] },
      { path: "search.batch", values: [16, 32] },
      { path: "axes.0.bins", values: [8, 9] },
    ]);
  });

  it("has fields that only one of them has", () => {
    const other = {
      ...one,
      search: { batch: 16, stop: { evaluations: 5 } },
      axes: [...one.axes, { name: "b" }],
    };
    expect(differences([one, other])).toEqual([
      { path: "search.stop", values: [null, undefined] },
      { path: "search.stop.evaluations", values: [undefined, 5] },
      { path: "axes.1.name", values: [undefined, "b"] },
    ]);
  });

  it("takes a list of plain values as one value, and as many specs as there are", () => {
    const values = [
      [1, 2],
      [1, 2],
      [2, 1],
    ];
    const specs = values.map((tiles) => ({ ...one, tiles }));
    expect(differences(specs)).toEqual([{ path: "tiles", values }]);
  });

  it.each([
    [undefined, "–"],
    [null, "none"],
    [true, "yes"],
    [0.0123456, "0.0123456"],
    [["a", 2], "a, 2"],
    [[], "none"],
  ])("writes %j as %s", (value, text) => {
    expect(valueText(value)).toBe(text);
  });
});

describe("groups of specs", () => {
  it("are those that differ in the seed alone, in the order of the first of each", () => {
    const spec = (viscosity: number, seed: number) => ({ world: { viscosity }, seed });
    expect(groupsOf([spec(0.2, 1), spec(0.1, 1), spec(0.2, 2), spec(0.1, 3)])).toEqual([0, 1, 0, 1]);
    expect(groupsOf([spec(0.2, 1), spec(0.2, 2)])).toEqual([0, 0]);
  });
});
