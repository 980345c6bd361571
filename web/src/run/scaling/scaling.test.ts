import { describe, expect, it } from "vitest";
import type { ResultRow, Run } from "../../api/types";
import { figuresOf, keyFigureOf } from "../figures";
import { timeLines } from "./ScalingRun";

const row = (values: Partial<ResultRow>): ResultRow => ({ creature: null, ...values });

describe("a measurement of scaling", () => {
  const rows = [
    row({ method: "microcosmos", nodes: 2000, seconds: 4, fluid: 3, memory_bytes: 5 }),
    row({ method: "microcosmos", nodes: 1000, seconds: 3, fluid: 3, memory_bytes: 4 }),
    row({ method: "all-pairs", nodes: 1000, seconds: 1, fluid: null, memory_bytes: null }),
  ];

  it("has a line for each part that was timed, and the exponents beside them", () => {
    const lines = timeLines(rows, { exponent: 1.02, exponent_all_pairs: null });
    expect(lines.map(({ name }) => name)).toEqual(["all parts", "fluid", "all-pairs repulsion"]);
    expect(lines[0]!.points.map(({ x, y }) => `${x} ${y}`)).toEqual(["1000 3", "2000 4"]);
    expect([lines[0]!.power, lines[2]!.power]).toEqual([1.02, null]);
  });

  it("has its own figures and a key figure", () => {
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
