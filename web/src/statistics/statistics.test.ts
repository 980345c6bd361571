/** Numbers and rows of the statistics of a sweep. */

import { describe, expect, it } from "vitest";
import type { MeasureStatistics } from "../api/types";
import { formatOf, intervalText, pairsOf, probability, summariesOf } from "./StatisticsCard";

const test = { test: "Mann–Whitney, exact", statistic: 0, p: 0.008 };

function measured(measure: string, less = false): MeasureStatistics {
  const figures = { n: 5, values: [], low: 0.5, median: 0.625, high: null };
  const mean = { iqm: null, iqm_low: null, iqm_high: null };
  const effect = { p_holm: 0.02, a12: 0, a12_low: 0, a12_high: 0 };
  return {
    measure,
    title: measure,
    less_is_better: less,
    groups: ["thin", "thick"].map((group) => ({ group, ...figures, ...mean })),
    overall: null,
    pairs: [{ group: "thin", other: "thick", ...test, ...effect }],
  };
}

describe("statistics of a sweep", () => {
  it("writes shares in per cent, also at a number of evaluations", () => {
    expect(formatOf(measured("coverage@800"))(0.625)).toBe("62.5 %");
    expect(formatOf(measured("best"))(0.625)).toBe("0.625");
    expect(formatOf(measured("best>=1", true))(12000)).toBe("12,000");
  });

  it("says where a run does not reach a value", () => {
    expect(intervalText(measured("best>=1", true), 80, null)).toBe("80 to not reached");
  });

  it("says where a run has no elites", () => {
    expect(formatOf(measured("best"))(null)).toBe("no elites");
  });

  it("writes small values of p as less", () => {
    expect([0.0004, 0.0456, 1].map(probability)).toEqual(["< 0.001", "0.046", "1.000"]);
  });

  it("names a measure in the first of its rows", () => {
    const measures = [measured("qd_score"), measured("best")];
    expect(summariesOf(measures).map(({ named }) => named)).toEqual(["Qd_score", "", "Best", ""]);
    expect(pairsOf(measures).map(({ named, pair }) => [named, pair.other])).toEqual([
      ["Qd_score", "thick"],
      ["Best", "thick"],
    ]);
    const keys = summariesOf(measures).map(({ key }) => key);
    expect(new Set(keys).size).toBe(keys.length);
  });
});
