import { describe, expect, it } from "vitest";
import type { Axis } from "../api/types";
import { cellAt, cellOf, placeOf, rectangle, ticks } from "./geometry";
import { type Direction, gridLayout, nextBin } from "./layout";

const SHAPE = [4, 3] as const;

describe("a cell", () => {
  it("counts in C order, the second axis fastest", () => {
    expect(cellOf({ i: 2, j: 1 }, SHAPE)).toBe(7);
    for (let cell = 0; cell < 12; cell++) expect(cellOf(placeOf(cell, SHAPE), SHAPE)).toBe(cell);
  });

  it("stands further right along the first axis and higher along the second", () => {
    expect(rectangle(0, SHAPE, 400, 300)).toEqual({ x: 0, y: 200, w: 100, h: 100 });
    expect(rectangle(11, SHAPE, 400, 300)).toEqual({ x: 300, y: 0, w: 100, h: 100 });
  });

  it("is found again under its own centre", () => {
    for (let cell = 0; cell < 12; cell++) {
      const { x, y, w, h } = rectangle(cell, SHAPE, 1, 1);
      expect(cellAt(x + w / 2, y + h / 2, SHAPE)).toBe(cell);
    }
    expect(cellAt(1, 0.5, SHAPE)).toBeNull();
    expect(cellAt(0.5, -0.01, SHAPE)).toBeNull();
  });
});

describe("the arrow keys", () => {
  const at = (i: number, j: number) => cellOf({ i, j }, [10, 10]);
  const filled = [at(1, 1), at(5, 1), at(2, 4), at(1, 8)];

  it.each<[Direction, number | null]>([
    ["ArrowRight", at(5, 1)],
    ["ArrowUp", at(2, 4)],
    ["ArrowLeft", null],
    ["ArrowDown", null],
  ])("%s goes to the nearest filled cell that way, or nowhere", (direction, expected) => {
    expect(nextBin(at(1, 1), direction, filled, gridLayout([10, 10]))).toBe(expected);
  });
});

describe("the ticks of an axis", () => {
  const axis = (low: number, high: number, scale: Axis["scale"]): Axis => {
    return { name: "bending_effort", low, high, bins: 20, scale };
  };

  it("are whole decades on a logarithmic scale", () => {
    const made = ticks(axis(1e-4, 1e2, "log10"), 7);
    expect(made.map(({ at }) => Number((6 * at).toFixed(9)))).toEqual([0, 1, 2, 3, 4, 5, 6]);
    made.forEach(({ value }, k) => expect(value).toBeCloseTo(10 ** (k - 4), 12));
  });

  it("are the ends where there is no decade between", () => {
    expect(ticks(axis(2, 8, "log10"))).toEqual([
      { at: 0, value: 2 },
      { at: 1, value: 8 },
    ]);
  });

  it("are round numbers on a linear scale, no more than asked for", () => {
    const made = ticks(axis(0, 0.15, "linear"), 6);
    expect(made.map(({ value }) => value)).toEqual([0, 0.05, 0.1, 0.15]);
    expect(made.at(-1)!.at).toBeCloseTo(1, 12);
  });
});
