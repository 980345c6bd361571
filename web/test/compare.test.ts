import { describe, expect, it, vi } from "vitest";
import type { Experiment, Run } from "../src/api/types";
import type { Curves } from "../src/live/curves";
import { overlaid, tableOf } from "../src/view/curves/look";
import { type Plot, scoresOf, valueAt } from "../src/view/curves/plots";
import { labelOf, titleOf } from "../src/view/format";
import { ariaSort, isFiltered, nextSort, queryOf } from "../src/view/runs/filters";
import { differences, written } from "../src/view/specs/difference";

describe("the difference between specs", () => {
  const one = { seed: 0, search: { batch: 16, stop: null }, axes: [{ name: "a", bins: 8 }], tiles: [1, 2] };

  it("is none where they are the same, in whatever order", () => {
    const { seed, ...rest } = one;
    expect(differences([one, { ...rest, seed }])).toEqual([]);
    expect(differences([one])).toEqual([]);
  });

  it("names the path and both values, down to items of lists", () => {
    const other = { ...one, seed: 7, search: { batch: 32, stop: null }, axes: [{ name: "a", bins: 9 }] };
    expect(differences([one, other])).toEqual([
      { path: "seed", values: [0, 7] },
      { path: "search.batch", values: [16, 32] },
      { path: "axes.0.bins", values: [8, 9] },
    ]);
  });

  it("has fields that only one of them has", () => {
    const other = {
      ...one,
      search: { batch: 16, stop: { evaluations: 5 } },
      axes: [...one.axes, { name: "b" }],
    };
    expect(differences([one, other])).toEqual([
      { path: "search.stop", values: [null, undefined] },
      { path: "search.stop.evaluations", values: [undefined, 5] },
      { path: "axes.1.name", values: [undefined, "b"] },
    ]);
  });

  it("takes a list of plain values as one value, and as many specs as there are", () => {
    const values = [
      [1, 2],
      [1, 2],
      [2, 1],
    ];
    const specs = values.map((tiles) => ({ ...one, tiles }));
    expect(differences(specs)).toEqual([{ path: "tiles", values }]);
  });

  it.each([
    [undefined, "–"],
    [null, "none"],
    [true, "yes"],
    [0.0123456, "0.0123456"],
    [["a", 2], "a, 2"],
    [[], "none"],
  ])("writes %j as %s", (value, text) => {
    expect(written(value)).toBe(text);
  });
});

describe("the list of runs in the address", () => {
  const query = (text: string) => queryOf(new URLSearchParams(text));

  it("asks for what the address says, and passes over what makes no sense", () => {
    expect(query("")).toEqual({});
    expect(query("q=wide &status=running,odd,queued&tag=a&experiment=gaits&sort=-best")).toEqual({
      q: "wide ",
      status: ["queued", "running"],
      tag: "a",
      experiment: ["gaits"],
      sort: "-best",
    });
    expect(query("sort=colour&status=odd")).toEqual({});
    expect([isFiltered(query("sort=best")), isFiltered(query("q=x"))]).toEqual([false, true]);
  });

  it("is sorted by a column, then the other way round, then as usual", () => {
    expect(["name", "-name", "best"].map((sort) => nextSort(sort, "name", false))).toEqual([
      "-name",
      null,
      "name",
    ]);
    expect(nextSort(undefined, "qd_score", true)).toBe("-qd_score");
    expect(nextSort("-qd_score", "qd_score", true)).toBe("qd_score");
    expect(["name", "-name", undefined].map((sort) => ariaSort(sort, "name"))).toEqual([
      "ascending",
      "descending",
      "none",
    ]);
  });
});

describe("what a run is called", () => {
  const run = { name: null, experiment: "quality-diversity", demonstration: false };

  it("is its name before anything else", () => {
    expect(labelOf({ ...run, name: "Mine", demonstration: true })).toBe("Mine");
    expect(titleOf({ ...run, name: "Mine" } as Run, [])).toBe("Mine");
    expect([labelOf(run), labelOf({ ...run, demonstration: true })]).toEqual([
      "Quality diversity",
      "Demonstration",
    ]);
  });

  it("is its preset's name whatever its seed, and the spec is read once", () => {
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

describe("curves over one axis", () => {
  const curves = (evaluations: number[], qd_score: (number | null)[]): Curves => {
    const generation = evaluations.map((_, i) => i + 1);
    const seconds = generation.map((each) => each / 10);
    return { generation, evaluations, seconds, qd_score, coverage: qd_score, best: qd_score, summary: {} };
  };
  const [small, large] = [curves([16, 32, 48], [1, 2, 3]), curves([32, 64], [10, null])];

  it("stand where each run told its values, all in their own colours", () => {
    const runs = [small, large].map((curves, i) => {
      return { name: `run ${i}`, colour: `--series-${i}`, ...(i === 1 && { dash: [7, 4] }), curves };
    });
    const look = { over: "evaluations", log: false, smooth: 1 } as const;
    const plots = overlaid(scoresOf, runs, look);
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
    expect(overlaid(scoresOf, [], look).map(({ series }) => series)).toEqual([[], [], []]);
  });

  it("have a value at every place between a run's first and last", () => {
    const x = [1, 2, 3, 4];
    const column = [null, 5, null, 6];
    expect(x.map((_, i) => valueAt(x, column, i))).toEqual([null, 5, 5, 6]);
    expect(valueAt(x, [5, null, null, null], 2)).toBeNull();
  });
});
