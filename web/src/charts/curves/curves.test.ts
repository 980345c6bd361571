import { describe, expect, it } from "vitest";
import { type Curves, MAX_POINTS, NO_CURVES, appendCurves } from "../../store/curves";
import { arrangePlots, curveViewOf, overlayPlots, placesOf, runningMean, tableOf } from "./curveView";
import { type Plot, infeasibleBy, scoresOf, valueAt, workOf } from "./plots";

const curvesOf = (qd_score: (number | null)[], batch = 16, summary = {}): Curves => {
  const generation = qd_score.map((_, i) => i + 1);
  const evaluations = generation.map((each) => batch * each);
  const rest = { coverage: qd_score, best: qd_score, seconds: generation, summary };
  return { generation, evaluations, qd_score, ...rest };
};

describe("the view of curves", () => {
  const plain = curveViewOf(new URLSearchParams());

  it("is in the address; unknown values are ignored", () => {
    expect(plain).toEqual({ over: "generation", log: false, smooth: 1 });
    const requested = new URLSearchParams("over=seconds&log=1&smooth=20");
    expect(curveViewOf(requested)).toEqual({ over: "seconds", log: true, smooth: 20 });
    expect(curveViewOf(new URLSearchParams("over=moons&log=yes&smooth=7"))).toEqual(plain);
  });

  it("marks generations at the first point from them on, each place once", () => {
    const curves = { ...curvesOf([1, 2, 3]), generation: [1, 5, 9] };
    expect(placesOf([1, 4, 5, 10], curves, plain)).toEqual([1, 5]);
    expect(placesOf([4], curves, { ...plain, over: "evaluations" })).toEqual([32]);
  });

  it("smooths by the mean of known values in a window of generations", () => {
    expect(runningMean([1, 2, 3, 4], [1, 2, 3, 4], 1)).toEqual([1, 2, 3, 4]);
    expect(runningMean([1, 2, 3, 4], [1, 2, 3, 4], 3)).toEqual([1, 1.5, 2, 3]);
    expect(runningMean([4, null, 8], [1, 2, 3], 5)).toEqual([4, null, 6]);
    // Thinned curves: the window counts generations, not points.
    expect(runningMean([1, 3, 5], [10, 20, 30], 20)).toEqual([1, 2, 4]);
  });

  it("keeps measured values faintly behind the smooth line", () => {
    const [score] = arrangePlots(scoresOf, curvesOf([1, 3]), [], { ...plain, smooth: 5 });
    expect(score!.series.map(({ faint }) => faint ?? false)).toEqual([true, false]);
    expect(score!.series.map(({ y }) => y)).toEqual([
      [1, 3],
      [1, 2],
    ]);
  });

  it("adds other runs in their colours, with their own x values", () => {
    const others = [{ name: "Demo 12", colour: "--series-2", curves: curvesOf([5, 6], 32) }];
    const view = { ...plain, over: "evaluations" } as const;
    const [score] = arrangePlots(scoresOf, curvesOf([1, 2]), others, view);
    expect(score!.series.map(({ colour }) => colour)).toEqual(["--series-1", "--series-2"]);
    expect(score!.series.map(({ other }) => other ?? false)).toEqual([false, true]);
    expect(tableOf(score!.series, false)).toEqual([
      [16, 32, 64],
      [1, 2, undefined],
      [undefined, 5, 6],
    ]);
  });

  it("omits values that are not positive on a log scale", () => {
    const series = [{ name: "a", colour: "", x: [1, 2, 3], y: [0, -1, 2] }];
    expect(tableOf(series, true)).toEqual([
      [1, 2, 3],
      [null, null, 2],
    ]);
    expect(tableOf(series, false)[1]).toEqual([0, -1, 2]);
  });
});

describe("infeasible evaluations", () => {
  const summary = { "infeasible.supersonic": [null, 2, 1], "infeasible.non-finite": [4, null, 3] };

  it("are counted by reason, most frequent first, and drawn as sums", () => {
    const curves = curvesOf([1, 2, 3], 16, summary);
    expect(infeasibleBy(curves)).toEqual([
      ["non-finite", 7],
      ["supersonic", 3],
    ]);
    const plot = workOf(curves).find(({ title }) => title === "Infeasible so far");
    expect(plot!.series.map(({ y }) => y)).toEqual([
      [4, 4, 7],
      [0, 2, 3],
    ]);
  });

  it("have a sentence for each reason of the engine", () => {
    const reasons = ["non-finite", "supersonic", "limits", "compressible", "impulse", "crossing"];
    const counted = Object.fromEntries(reasons.map((reason) => [`infeasible.${reason}`, [1]]));
    const plot = workOf(curvesOf([1], 16, counted)).find(({ title }) => title === "Infeasible so far");
    expect(plot!.series.map(({ about }) => about)).toEqual(
      reasons.map(() => expect.stringMatching(/^[A-Z].*\.$/)),
    );
  });

  it("are not lost if a long history is thinned out", () => {
    let curves = NO_CURVES;
    const length = 2 * MAX_POINTS + 3;
    for (let generation = 1; generation <= length; generation++) {
      const figures = { qd_score: 1, coverage: 1, best: 1, mean: 1, infeasible: 0, evaluations: 1 };
      const summary = { "infeasible.non-finite": 1, ...(generation === 2 && { rare: 5 }) };
      curves = appendCurves(curves, { run: "", generation, seconds: 1, ...figures, summary });
    }
    expect(curves.generation.length).toBeLessThanOrEqual(MAX_POINTS + 1);
    expect(infeasibleBy(curves)).toEqual([["non-finite", length]]);
    expect(curves.summary["rare"]!.filter((value) => value !== null)).toEqual([5]);
  });
});

describe("curves", () => {
  const bare = curvesOf([1]);

  it("have re-evaluations and work if they were reported", () => {
    expect(scoresOf(bare).map(({ series }) => series.length)).toEqual([1, 1, 1]);
    expect(workOf(bare)).toEqual([]);
    const complete = curvesOf([1], 16, {
      corrected_qd_score: [0.8],
      "emitter.neat.inserted": [3],
      "emitter.iso+line.inserted": [4],
      "emitter.neat.improved": [0],
      device_seconds: [0.1],
    });
    expect(scoresOf(complete)[0]!.series[1]).toMatchObject({ y: [0.8], dots: true });
    expect(workOf(complete).map(({ title, series }) => [title, ...series.map(({ name }) => name)])).toEqual([
      ["Into empty cells", "neat", "iso+line"],
      ["Improvements", "neat"],
      ["Device-seconds", "device_seconds"],
    ]);
  });
});

describe("curves over one axis", () => {
  const [small, large] = [curvesOf([1, 2, 3]), curvesOf([10, null], 32)];

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
    expect(tableOf(series, false)).toEqual([
      [16, 32, 48, 64],
      [1, 2, 3, undefined],
      [undefined, 10, undefined, undefined],
    ]);
    expect(overlayPlots(scoresOf, [], view).map(({ series }) => series)).toEqual([[], [], []]);
  });

  it("have a value at every point between the first and the last", () => {
    const column = [null, 5, null, 6];
    expect(column.map((_, i) => valueAt(column, i))).toEqual([null, 5, 5, 6]);
    expect(valueAt([5, null, null, null], 2)).toBeNull();
  });
});
