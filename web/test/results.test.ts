import { describe, expect, it } from "vitest";
import { NO_CURVES } from "../src/live/curves";
import type { ResultRow, Run, Spec } from "../src/api/types";
import { fromZero, logAround, place, ticksOf } from "../src/view/plot/scale";
import { columnsOf, sortRows } from "../src/view/results/columns";
import { figuresOf, keyFigureOf } from "../src/view/results/figures";
import { reynoldsAxis, sweepAxes, sweepLines } from "../src/view/results/gaits";
import { courseOf } from "../src/view/results/learning";
import { timeLines } from "../src/view/results/scaling";

const row = (values: Partial<ResultRow>): ResultRow => ({ creature: null, ...values });

describe("an axis", () => {
  it("has a decade everywhere the same length where it is logarithmic", () => {
    const scale = { log: true, low: 0.01, high: 100 };
    expect([0.01, 0.1, 1, 100].map((value) => place(scale, value))).toEqual([0, 0.25, 0.5, 1]);
    expect(place({ log: false, low: -1, high: 3 }, 0)).toBe(0.25);
  });

  it("has room for all values and begins at zero unless some are below", () => {
    expect(fromZero([1, 4])).toMatchObject({ low: 0 });
    expect(fromZero([-1, 4]).low).toBeLessThan(-1);
    const { low, high } = logAround([0.001, 2, 0]);
    expect([low > 0, low < 0.001, high > 2]).toEqual([true, true, true]);
  });

  it("has names within less than a decade too", () => {
    expect(ticksOf(logAround([0.3]), 8)).toEqual([0.24, 0.26, 0.28, 0.3, 0.32, 0.34, 0.36]);
    expect(ticksOf({ log: true, low: 8, high: 11 }, 3)).toEqual([8, 9, 10, 11]);
  });

  it("names as many round values as there is room for", () => {
    const wide = { log: true, low: 0.0009, high: 2.2 };
    expect(ticksOf(wide, 12)).toEqual([0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2]);
    expect(ticksOf(wide, 5)).toEqual([0.001, 0.01, 0.1, 1]);
    expect(ticksOf(wide, 2)).toEqual([0.001, 0.1]);
    expect(ticksOf({ log: false, low: 0, high: 1.07 }, 6)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
  });
});

describe("a table", () => {
  const rows = [
    row({ swimmer: "ray", displacement: 2 }),
    row({ swimmer: "worm", displacement: null }),
    row({ swimmer: "cilia", displacement: 10 }),
  ];
  const order = (by: string | null, down: boolean) =>
    sortRows(rows, { by, down }).map(({ swimmer }) => swimmer);

  it("is in the order of a column, numbers by size, and what is missing last either way", () => {
    expect(order("displacement", false)).toEqual(["ray", "cilia", "worm"]);
    expect(order("displacement", true)).toEqual(["cilia", "ray", "worm"]);
    expect(order("swimmer", false)).toEqual(["cilia", "ray", "worm"]);
    expect(order(null, false)).toEqual(["ray", "worm", "cilia"]);
  });

  it("has every column that any row has, with its unit, also one nobody foresaw", () => {
    const columns = columnsOf([...rows, row({ limited: 0.5, novelty: true })]);
    const told = columns.map(({ title, unit, numeric }) => [title, unit, numeric]);
    expect(told).toEqual([
      ["Swimmer", "", false],
      ["Displacement", "cells/cycle", true],
      ["Limited", "of node steps", true],
      ["Novelty", "", false],
    ]);
    expect(columns[2]!.write(0.5)).toBe("50 %");
    expect(columns[3]!.write(true)).toBe("yes");
  });
});

describe("a sweep of gaits", () => {
  const spec: Spec = { swimmers: ["worm", "ray"], viscosities: [0.01, 1], forms: ["ours"] };
  const point = (values: Partial<ResultRow>) =>
    row({ form: "ours", status: "ok", swimmer: "worm", limited: 0, warnings: "", ...values });
  const rows = [
    point({ viscosity: 1, displacement: 0.5, reynolds: 2, creature: "ab" }),
    point({ viscosity: 0.01, displacement: 3, reynolds: 200, limited: 0.1 }),
    point({ viscosity: 0.01, swimmer: "ray", displacement: null, status: "non-finite" }),
  ];
  const [worm, ray] = sweepLines(spec, rows, (sha) => `/creatures/${sha}`);

  it("has a line for each swimmer, from the lowest viscosity to the highest", () => {
    expect(worm!.points.map(({ x, y }) => [x, y])).toEqual([
      [0.01, 3],
      [1, 0.5],
    ]);
    expect(worm!.points[1]!.href).toBe("/creatures/ab");
    expect(worm!.points[1]!.says).toEqual(["Worm at ν = 1", "0.5 cells a cycle", "Reynolds number 2"]);
  });

  it("marks what limits or warnings make doubtful, and what did not finish", () => {
    expect(worm!.points.map(({ hollow }) => hollow)).toEqual([true, false]);
    expect(worm!.points[0]!.says).toContain("limited in 10 % of node steps");
    expect(ray!.points[0]!.y).toBeNull();
    expect(ray!.points[0]!.says[1]).toBe("Non-finite");
  });

  it("has the worm's Reynolds numbers above its viscosities", () => {
    expect(reynoldsAxis(rows)).toEqual({
      title: "Reynolds number of the worm",
      ticks: [
        { at: 0.01, text: "200" },
        { at: 1, text: "2" },
      ],
    });
    expect(reynoldsAxis([rows[2]!])).toBeNull();
  });

  it("leaves out of its axis what did not finish", () => {
    const burst = point({ viscosity: 1, displacement: 1e6, status: "supersonic" });
    expect(sweepAxes(spec, [...rows, burst]).y.scale).toEqual(sweepAxes(spec, rows).y.scale);
  });

  it("has the same axes before its results and after", () => {
    expect(sweepAxes(spec, []).x).toEqual(expect.objectContaining({ scale: sweepAxes(spec, rows).x.scale }));
  });
});

describe("a measurement of scaling", () => {
  const rows = [
    row({ method: "microcosmos", nodes: 2000, seconds: 4, fluid: 3, memory_bytes: 5 }),
    row({ method: "microcosmos", nodes: 1000, seconds: 3, fluid: 3, memory_bytes: 4 }),
    row({ method: "all-pairs", nodes: 1000, seconds: 1, fluid: null, memory_bytes: null }),
  ];

  it("has a line for each part that was timed, and the exponents beside them", () => {
    const lines = timeLines(rows, { exponent: 1.02, exponent_all_pairs: null });
    expect(lines.map(({ name }) => name)).toEqual(["all parts", "fluid", "all-pairs repulsion"]);
    expect(lines[0]!.points.map(({ x, y }) => [x, y])).toEqual([
      [1000, 3],
      [2000, 4],
    ]);
    expect([lines[0]!.power, lines[2]!.power]).toEqual([1.02, null]);
  });

  it("has figures of its own, and one that stands for it", () => {
    const summary = { exponent: 1.0213, peak_memory_bytes: 2_500_000 };
    const run = { experiment: "scaling", summary } as unknown as Run;
    expect(Object.fromEntries(figuresOf(run))).toMatchObject({
      Exponent: "1.02",
      "All-pairs exponent": "–",
      "Peak memory": "2.5 MB",
    });
    expect(keyFigureOf(run)).toEqual(["exponent", "1.02"]);
    const small = { ...run, summary: { exponent: null, peak_memory_bytes: 2_500_000 } };
    expect(keyFigureOf(small)).toEqual(["peak memory", "2.5 MB"]);
  });
});

describe("a course", () => {
  const curves = (summary: Record<string, number[]>) => ({ ...NO_CURVES, generation: [1, 2, 3], summary });
  const run = (experiment: string) => ({ experiment, generations: 3 }) as unknown as Run;

  it("names values apart that hardly differ", () => {
    const { y } = courseOf(run("refinement"), curves({ fitness: [2.956, 3.01, 3.018] }));
    const names = ticksOf(y.scale, 8).map(y.write);
    expect(names.length).toBeGreaterThan(3);
    expect(new Set(names).size).toBe(names.length);
  });

  it("has a line for each picture that a filament folds into", () => {
    const told = {
      "loss of 3": [0.1, 0.05, 0.02],
      "loss of 7": [0.1, 0.04, 0.01],
      loss: [0.1, 0.045, 0.015],
    };
    const { lines } = courseOf(run("folding"), curves(told));
    expect(lines.map(({ name }) => name)).toEqual(["3", "7"]);
    expect(lines[1]!.points.map(({ y }) => y)).toEqual([0.1, 0.04, 0.01]);
  });
});
