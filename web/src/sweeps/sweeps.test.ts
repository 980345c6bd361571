/** Plots and names of the cases of a sweep. */

import { describe, expect, it } from "vitest";
import type { CaseSummary } from "../api/types";
import { summaryPlotsOf, caseName } from "./summaryPlots";

const none = { median: [null], low: [null], high: [null], min: [null], max: [null] };

function summaryOf(generation: number[], median: number[]): CaseSummary {
  const band = { median, low: median.map((v) => v - 1), high: median.map((v) => v + 1) };
  const qd_score = { ...band, min: band.low, max: band.high };
  const progress = { status: "running" as const, generation: 2, generations: 3 };
  const members = [{ run: "a", seed: 0, ...progress, face: null, best: null }];
  const empty = generation.length > 0 ? none : { median: [], low: [], high: [], min: [], max: [] };
  const runs = generation.map(() => 1);
  return { values: {}, members, generation, runs, qd_score, coverage: empty, best: empty, finals: {} };
}

describe("the bands of a sweep", () => {
  const shown = (summary: CaseSummary, caseIndex: number) => ({
    summary,
    caseIndex,
    name: `case ${caseIndex}`,
    colour: `--series-${caseIndex}`,
    dash: undefined,
  });

  it("lie between the quartiles of each case, with the median in them", () => {
    const cases = [summaryOf([1, 2], [5, 6]), summaryOf([1], [7])].map(shown);
    const [plot, ...others] = summaryPlotsOf(cases, null);
    expect(others).toEqual([]);
    expect(plot!.series.map(({ y }) => y)).toEqual([[6, 7], [4, 5], [5, 6], [8], [6], [7]]);
    expect(plot!.bands!.map(({ high, low }) => [high, low])).toEqual([
      [0, 1],
      [3, 4],
    ]);
    expect(plot!.series.filter(({ edge }) => !edge).map(({ name }) => name)).toEqual(["case 0", "case 1"]);
  });

  it("have the runs of their case behind them on request", () => {
    const line = { qd_score: [4, 5], coverage: [null, null], best: [null, null] };
    const lines = [
      { run: "a", ...line },
      { run: "of another case", ...line },
    ];
    const [plot] = summaryPlotsOf([shown(summaryOf([1, 2], [5, 6]), 0)], { generation: [1, 2], runs: lines });
    expect(plot!.series.map(({ faint = false }) => faint)).toEqual([true, false, false, false]);
    expect(plot!.bands).toEqual([{ high: 1, low: 2, colour: "--series-0" }]);
  });

  it("are named by the last words of their fields, unless those are the same", () => {
    expect(caseName({ "world.viscosity": 0.05, "body.nodes": 16 })).toBe("viscosity 0.05, nodes 16");
    const seeds = { "body.seed": 1, "archive.seed": 2 };
    expect(caseName(seeds)).toBe("body.seed 1, archive.seed 2");
    expect(caseName({})).toBe("all runs");
  });
});
