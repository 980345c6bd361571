import { describe, expect, it, vi } from "vitest";
import type { Experiment, Run } from "../api/types";
import { labelOf, titleOf } from "./format";

describe("the title of a run", () => {
  const run = { name: null, experiment: "quality-diversity", demonstration: false };

  it("is its name, if it has one", () => {
    expect(labelOf({ ...run, name: "Mine", demonstration: true })).toBe("Mine");
    expect(titleOf({ ...run, name: "Mine" } as Run, [])).toBe("Mine");
    expect([labelOf(run), labelOf({ ...run, demonstration: true })]).toEqual([
      "Quality diversity",
      "Demonstration",
    ]);
  });

  it("is its preset's name for any seed, and the spec is read once", () => {
    const reads = vi.fn();
    const spec = {
      experiment: "gaits",
      get swimmers() {
        reads();
        return ["a"];
      },
      seed: 7,
    };
    const presets = [
      { name: "one", spec: { experiment: "gaits", swimmers: ["b"], seed: 0 } },
      { name: "two", spec: { experiment: "gaits", swimmers: ["a"], seed: 0 } },
    ];
    const experiments = [{ experiment: "gaits", presets }] as unknown as Experiment[];
    const gaits = { ...run, experiment: "gaits", spec } as unknown as Run;
    expect([titleOf(gaits, experiments), titleOf({ ...gaits }, experiments)]).toEqual([
      "Gaits, two",
      "Gaits, two",
    ]);
    expect(reads).toHaveBeenCalledTimes(1);
  });
});
