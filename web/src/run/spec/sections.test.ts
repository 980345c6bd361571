import { describe, expect, it } from "vitest";
import type { Preset } from "../../api/types";
import { brief, nameOf, nearestPreset, sectionsOf } from "./sections";

describe("a spec that is read", () => {
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

  it("is told by the preset that it is nearest to, whatever the seed", () => {
    const found = nearestPreset(spec, presets)!;
    expect(found.preset.name).toBe("near");
    expect(found.changed.map(({ path }) => path)).toEqual(["search.batch"]);
    expect(nearestPreset(spec, [])).toBeNull();
  });

  it("has a section for each part, in which what differs stands out", () => {
    const sections = sectionsOf(spec, nearestPreset(spec, presets)!.changed);
    expect(sections.map(({ title }) => title)).toEqual(["Run", "Search", "Axes", "World"]);
    const [batch, stop] = sections[1]!.fields;
    expect(batch).toEqual({ path: "search.batch", name: "Batch", text: "64", usual: "16" });
    expect(stop!.usual).toBeNull();
    expect(sections[2]!.fields[0]!.name).toBe("1, name");
  });

  it("names fields by words and cuts what is long", () => {
    expect(nameOf(["descriptors", "0", "bins"])).toBe("Descriptors 1, bins");
    expect(brief("x".repeat(500)).length).toBeLessThan(130);
  });
});
