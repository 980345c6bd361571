import { describe, expect, it } from "vitest";
import { differences, written } from "./difference";

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
