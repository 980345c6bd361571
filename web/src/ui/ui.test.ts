import { describe, expect, it, vi } from "vitest";
import type { Experiment, Run, Spec } from "../api/types";
import { diverging, viridis } from "./colours";
import { bytes, count, duration, labelOf, number, percent, titleOf } from "./format";
import { aboutOf, groupOf, titleOf as titleOfMeasure, valueOf } from "./measures";
import { define, parse } from "./Term";
import { reasonOf } from "./Page";

describe("colours", () => {
  it("of viridis go from dark violet to yellow and get lighter", () => {
    const lightness = Array.from({ length: 33 }, (_, i) => {
      const [red, green, blue] = viridis(i / 32);
      return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    });
    for (let i = 1; i < 33; i++) expect(lightness[i]!).toBeGreaterThan(lightness[i - 1]!);
    // The ends of the published map are (68, 1, 84) and (253, 231, 37).
    [68, 1, 84].forEach((value, k) => expect(Math.abs(viridis(0)[k]! - value)).toBeLessThan(5));
    [253, 231, 37].forEach((value, k) => expect(Math.abs(viridis(1)[k]! - value)).toBeLessThan(5));
  });

  it.each(["light", "dark"] as const)("for vorticity are clipped and opposite in %s", (theme) => {
    expect(diverging(-2, theme)).toEqual(diverging(-1, theme));
    expect(diverging(-1, theme)[2]).toBeGreaterThan(diverging(-1, theme)[0]);
    expect(diverging(1, theme)[0]).toBeGreaterThan(diverging(1, theme)[2]);
  });
});

describe("formats", () => {
  it.each([
    [0, "0"],
    [0.012345, "0.0123"],
    [1234.5, "1,235"],
    [98300000, "9.83 × 10⁷"],
    [0.0001, "10⁻⁴"],
    [-0.0343574, "−0.0344"],
    [-0, "0"],
    [null, "–"],
  ])("write %j as %s", (value, text) => {
    expect(number(value)).toBe(text);
  });

  it("say 100 % of all alone, and count nothing without a sign", () => {
    expect([1, 4095 / 4096, 0.9994, 0.5, 0, 1.2].map(percent)).toEqual([
      "100 %",
      "99.9 %",
      "99.9 %",
      "50 %",
      "0 %",
      "120 %",
    ]);
    expect([1234.5, -0.2].map(count)).toEqual(["1,235", "0"]);
  });

  it("of times and sizes are short", () => {
    expect([0.2, 59, 61, 3700, 90000].map(duration)).toEqual([
      "under 1 s",
      "59 s",
      "1 min 1 s",
      "1 h 1 min",
      "1 d 1 h",
    ]);
    expect(bytes(15_100_000)).toBe("15.1 MB");
  });

  it("of a run name its preset for any seed, or its experiment", () => {
    const spec: Spec = { seed: 0, world: { width: 32, height: 32 } };
    const presets = [{ name: "demo", title: "", spec }];
    const known = [{ experiment: "quality-diversity", title: "", about: "", schema: {}, presets }];
    const run = { experiment: "quality-diversity", demonstration: false } as Run;
    const same = { world: { height: 32, width: 32 }, seed: 9 };
    expect(titleOf({ ...run, spec: same }, known)).toBe("Demo");
    expect(titleOf({ ...run, spec: { seed: 0 } }, known)).toBe("Quality diversity");
    const gaits = known.map((one) => ({ ...one, experiment: "gaits" }));
    expect(titleOf({ ...run, experiment: "gaits", spec: same }, gaits)).toBe("Gaits, demo");
  });
});

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

describe("the glossary", () => {
  it("has terms with plain definitions", () => {
    const markdown = "# G\n\nIntro.\n\n## QD score\n\nA `sum` of\n[elites](a.md).\n\n## Run\n\nOne.\n";
    expect([...parse(markdown)]).toEqual([
      ["qd score", "A sum of elites."],
      ["run", "One."],
    ]);
  });

  it("is that of the documentation", () => {
    expect(define("QD score")).toMatch(/^The sum of the fitness/);
    expect(define("Niche")).toBeUndefined();
  });
});

describe("measures", () => {
  it("have titles, units and meanings; those of plug-ins have their own", () => {
    expect(titleOfMeasure("impulse")).toBe("Net impulse");
    expect(valueOf("impulse", 0.25)).toBe("0.25 mass · cells/step");
    expect(valueOf("crossing", 0.125)).toBe("12.5 %");
    expect(aboutOf("Spread over trials")).toBe("Standard deviation of fitness over task.trials; 0 with one.");
    const sway = { title: "Sway", unit: "cells" };
    expect([titleOfMeasure("mine.sway", sway), valueOf("mine.sway", 2, sway)]).toEqual(["Sway", "2 cells"]);
    expect([titleOfMeasure("some_number"), valueOf("some_number", 2)]).toEqual(["Some number", "2"]);
    expect([groupOf("form_aspect"), groupOf("mine.sway")]).toEqual(["form", "result"]);
  });
});

describe("the page of a missing resource", () => {
  it.each(["0190a6a0-0000-7000-8000-000000000001", "ab".repeat(32)])("repeats the server about %s", (id) => {
    expect(reasonOf("No such run.", id)).toBe("No such run.");
  });

  it("names a malformed id and hides the parser's message", () => {
    const reason = reasonOf("Input should be a valid UUID, invalid length", "abc");
    expect(reason).toContain("abc");
    expect(reason).not.toContain("UUID");
  });
});
