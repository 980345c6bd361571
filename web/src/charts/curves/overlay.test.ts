import { describe, expect, it } from "vitest";
import type { Curves } from "../../store/curves";
import { overlayPlots, tableOf } from "./curveView";
import { type Plot, scoresOf, valueAt } from "./plots";

describe("curves over one axis", () => {
  const curves = (evaluations: number[], qd_score: (number | null)[]): Curves => {
    const generation = evaluations.map((_, i) => i + 1);
    const seconds = generation.map((each) => each / 10);
    return { generation, evaluations, seconds, qd_score, coverage: qd_score, best: qd_score, summary: {} };
  };
  const [small, large] = [curves([16, 32, 48], [1, 2, 3]), curves([32, 64], [10, null])];

  it("are at the x values of their runs, in their colours", () => {
    const runs = [small, large].map((curves, i) => {
      return { name: `run ${i}`, colour: `--series-${i}`, ...(i === 1 && { dash: [7, 4] }), curves };
    });
    const view = { over: "evaluations", log: false, smooth: 1 } as const;
    const plots = overlayPlots(scoresOf, runs, view);
    expect(plots.map(({ title }) => title)).toEqual(["QD score", "Coverage", "Best fitness"]);
    const [{ series }] = plots as [Plot];
    expect(series.map(({ name, colour, dash }) => [name, colour, dash])).toEqual([
      ["run 0", "--series-0", undefined],
      ["run 1", "--series-1", [7, 4]],
    ]);
    expect(tableOf(series, [], false)).toEqual([
      [16, 32, 48, 64],
      [1, 2, 3, undefined],
      [undefined, 10, undefined, undefined],
    ]);
    expect(overlayPlots(scoresOf, [], view).map(({ series }) => series)).toEqual([[], [], []]);
  });

  it("have a value at every point between the first and the last", () => {
    const x = [1, 2, 3, 4];
    const column = [null, 5, null, 6];
    expect(x.map((_, i) => valueAt(x, column, i))).toEqual([null, 5, 5, 6]);
    expect(valueAt(x, [5, null, null, null], 2)).toBeNull();
  });
});
