import { describe, expect, it } from "vitest";
import type { LogEntry, Preset, Run } from "../src/api/types";
import { type Curves, LONGEST, NO_CURVES, appendCurves } from "../src/live/curves";
import { dressed, lookOf, runningMean, tableOf } from "../src/view/curves/look";
import { divergedBy, scoresOf, workOf } from "../src/view/curves/plots";
import { doingOf, elapsedOf } from "../src/view/Doing";
import { atLeast, summaryOf, textOf } from "../src/view/log/LogList";
import { placeOf } from "../src/view/replay/fold";
import { brief, nameOf, nearestPreset, sectionsOf } from "../src/view/specs/sections";
import { colourOf, lifeOf, pathOf, speciesAt, stackOf } from "../src/view/species/stack";

const curvesOf = (qd_score: (number | null)[], batch = 16, summary = {}): Curves => {
  const generation = qd_score.map((_, i) => i + 1);
  const evaluations = generation.map((each) => batch * each);
  const rest = { coverage: qd_score, best: qd_score, seconds: generation, summary };
  return { generation, evaluations, qd_score, ...rest };
};

describe("how curves are looked at", () => {
  const plain = lookOf(new URLSearchParams());

  it("is in the address, and what is no choice there is none", () => {
    expect(plain).toEqual({ over: "generation", log: false, smooth: 1 });
    const asked = new URLSearchParams("over=seconds&log=1&smooth=20");
    expect(lookOf(asked)).toEqual({ over: "seconds", log: true, smooth: 20 });
    expect(lookOf(new URLSearchParams("over=moons&log=yes&smooth=7"))).toEqual(plain);
  });

  it("smooths by the mean of so many generations, of what was told in them", () => {
    expect(runningMean([1, 2, 3, 4], [1, 2, 3, 4], 1)).toEqual([1, 2, 3, 4]);
    expect(runningMean([1, 2, 3, 4], [1, 2, 3, 4], 3)).toEqual([1, 1.5, 2, 3]);
    expect(runningMean([4, null, 8], [1, 2, 3], 5)).toEqual([4, null, 6]);
    // Thinned curves: the window counts generations, not points.
    expect(runningMean([1, 3, 5], [10, 20, 30], 20)).toEqual([1, 2, 4]);
  });

  it("keeps what was measured faintly behind the smooth line", () => {
    const [score] = dressed(scoresOf, curvesOf([1, 3]), [], { ...plain, smooth: 5 });
    expect(score!.series.map(({ faint }) => faint ?? false)).toEqual([true, false]);
    expect(score!.series.map(({ y }) => y)).toEqual([
      [1, 3],
      [1, 2],
    ]);
  });

  it("puts other runs beside, each in its colour and at its own places", () => {
    const others = [{ name: "Demo 12", colour: "--series-2", curves: curvesOf([5, 6], 32) }];
    const look = { ...plain, over: "evaluations" } as const;
    const [score] = dressed(scoresOf, curvesOf([1, 2]), others, look);
    expect(score!.series.map(({ colour }) => colour)).toEqual(["--series-1", "--series-2"]);
    expect(score!.series.map(({ other }) => other ?? false)).toEqual([false, true]);
    expect(tableOf(score!.series, [16, 32], false)).toEqual([
      [16, 32, 64],
      [1, 2, undefined],
      [undefined, 5, 6],
    ]);
  });

  it("leaves out on a log scale what is not above zero", () => {
    const series = [{ name: "a", colour: "", y: [0, -1, 2] }];
    expect(tableOf(series, [1, 2, 3], true)).toEqual([
      [1, 2, 3],
      [null, null, 2],
    ]);
    expect(tableOf(series, [1, 2, 3], false)[1]).toEqual([0, -1, 2]);
  });
});

describe("diverged evaluations", () => {
  const summary = { "diverged: supersonic": [null, 2, 1], "diverged: non-finite": [4, null, 3] };

  it("are counted for each reason, most first, and drawn as sums", () => {
    const curves = curvesOf([1, 2, 3], 16, summary);
    expect(divergedBy(curves)).toEqual([
      ["non-finite", 7],
      ["supersonic", 3],
    ]);
    const plot = workOf(curves).find(({ title }) => title === "Diverged so far");
    expect(plot!.series.map(({ y }) => y)).toEqual([
      [4, 4, 7],
      [0, 2, 3],
    ]);
  });

  it("are not lost where a long history is thinned out", () => {
    let curves = NO_CURVES;
    const length = 2 * LONGEST + 3;
    for (let generation = 1; generation <= length; generation++) {
      const figures = { qd_score: 1, coverage: 1, best: 1, mean: 1, diverged: 0, evaluations: 1 };
      const told = { "diverged: non-finite": 1, ...(generation === 2 && { rare: 5 }) };
      curves = appendCurves(curves, { run: "", generation, seconds: 1, ...figures, summary: told });
    }
    expect(curves.generation.length).toBeLessThanOrEqual(LONGEST + 1);
    expect(divergedBy(curves)).toEqual([["non-finite", length]]);
    expect(curves.summary["rare"]!.filter((value) => value !== null)).toEqual([5]);
  });
});

describe("a log", () => {
  const entry = (id: number, level: LogEntry["level"], text: string): LogEntry => ({
    id,
    at: `2026-01-01T00:00:0${id}Z`,
    level,
    attempt: 1,
    text,
  });
  const entries = [entry(1, "info", "Begins."), entry(2, "warning", "Full."), entry(3, "error", "Ended.")];

  it("shows a level and those above it", () => {
    expect(atLeast(entries, "info")).toEqual(entries);
    expect(atLeast(entries, "warning").map(({ id }) => id)).toEqual([2, 3]);
    expect(atLeast(entries, "error").map(({ id }) => id)).toEqual([3]);
  });

  it("is copied as lines in the order in which it happened", () => {
    expect(textOf(entries.slice(0, 2))).toBe(
      "2026-01-01T00:00:01Z info [attempt 1] Begins.\n2026-01-01T00:00:02Z warning [attempt 1] Full.",
    );
  });

  it("tells of a traceback the line that says what went wrong", () => {
    const text = "Attempt 1 ended badly: Traceback:\n  File x\nValueError: no";
    expect(summaryOf(text)[0]).toBe("Attempt 1 ended badly: ValueError: no");
    expect(summaryOf(text).slice(1)).toEqual(text.split("\n"));
    expect(summaryOf("Finished.")).toEqual(["Finished."]);
  });
});

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

describe("species over time", () => {
  const history = { generation: [1, 2, 3], number: [[0], [0, 2], [2]], members: [[8], [5, 3], [8]] };
  const stack = stackOf(history);

  it("fill the population, the oldest lowest", () => {
    expect(stack.size).toBe(8);
    expect(stack.areas.map(({ number }) => number)).toEqual([0, 2]);
    expect(stack.areas[1]).toEqual({ number: 2, from: [8, 5, 0], to: [8, 8, 8] });
  });

  it("are told at a place with their size", () => {
    expect(speciesAt(stack, 1, 4)).toEqual([0, 5]);
    expect(speciesAt(stack, 1, 6)).toEqual([2, 3]);
    expect(speciesAt(stack, 1, 9)).toBeNull();
  });

  it("grow from nothing and shrink to nothing", () => {
    expect(lifeOf(stack.areas[0]!)).toEqual([0, 2]);
    expect(lifeOf({ from: [0, 0, 0, 0, 0], to: [0, 0, 1, 0, 0] })).toEqual([1, 3]);
    const path = pathOf(
      stack.areas[0]!,
      (i) => 10 * i,
      (v) => 8 - v,
    );
    expect(path).toBe("M0.0 0.0L10.0 3.0L20.0 8.0L20.0 8.0L10.0 8.0L0.0 8.0Z");
  });

  it("differ in colour from those that arose beside them", () => {
    const lightness = (number: number) => {
      const [r, g, b] = colourOf(number).match(/\d+/g)!.map(Number) as [number, number, number];
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    for (let number = 0; number < 50; number++) {
      expect(Math.abs(lightness(number) - lightness(number + 1))).toBeGreaterThan(25);
    }
  });
});

describe("what a run is doing before its figures tell", () => {
  const run = {
    status: "running",
    generation: 0,
    device: "cpu, a processor",
    created_at: "2026-01-01T00:00:00Z",
    started_at: "2026-01-01T00:01:00Z",
  } as Run;

  it("is said, and for how long", () => {
    expect(doingOf(run)).toContain("most of a minute on a CPU");
    expect(doingOf({ ...run, device: "gpu, fast" })).not.toContain("CPU");
    expect(doingOf({ ...run, generation: 1 })).toBeNull();
    expect(doingOf({ ...run, status: "finished" })).toBeNull();
    const queued = { ...run, status: "queued", queued_at: "2026-01-01T00:01:30Z" } as Run;
    expect(doingOf({ ...queued, waiting: "All workers are busy." })).toBe("All workers are busy.");
    const now = Date.parse("2026-01-01T00:01:42Z");
    expect(elapsedOf(run, now)).toBe("42 s");
    expect(elapsedOf(queued, now)).toBe("12 s");
  });
});

describe("the picture under a filament", () => {
  it("lies in the middle of the world, as large as the spec has it", () => {
    const target = { name: "3", width: 8, height: 16, size: 32, pixels: "" };
    expect(placeOf(target, [48, 64])).toEqual({ left: 15.5, top: 47.5, wide: 16, high: 32 });
  });
});
