import { describe, expect, it } from "vitest";
import {
  type Direction,
  binAt,
  binFrom,
  columnAndRow,
  cornerOf,
  gridLayout,
  nextBin,
  rectangle,
  visibleBins,
} from "./layout";

const SHAPE = [4, 3] as const;

describe("a bin", () => {
  it("counts in C order, the second axis fastest", () => {
    expect(binFrom({ i: 2, j: 1 }, SHAPE)).toBe(7);
    for (let bin = 0; bin < 12; bin++) expect(binFrom(columnAndRow(bin, SHAPE), SHAPE)).toBe(bin);
  });

  it("is further right along the first axis and higher along the second", () => {
    expect(rectangle(0, SHAPE, 400, 300)).toEqual({ x: 0, y: 200, w: 100, h: 100 });
    expect(rectangle(11, SHAPE, 400, 300)).toEqual({ x: 300, y: 0, w: 100, h: 100 });
  });

  it("is found at its own centre", () => {
    for (let bin = 0; bin < 12; bin++) {
      const { x, y, w, h } = rectangle(bin, SHAPE, 1, 1);
      expect(binAt(x + w / 2, y + h / 2, SHAPE)).toBe(bin);
    }
    expect(binAt(1, 0.5, SHAPE)).toBeNull();
    expect(binAt(0.5, -0.01, SHAPE)).toBeNull();
  });
});

describe("the arrow keys", () => {
  const at = (i: number, j: number) => binFrom({ i, j }, [10, 10]);
  const filled = [at(1, 1), at(5, 1), at(2, 4), at(1, 8)];

  it.each<[Direction, number | null]>([
    ["ArrowRight", at(5, 1)],
    ["ArrowUp", at(2, 4)],
    ["ArrowLeft", null],
    ["ArrowDown", null],
  ])("%s goes to the nearest filled bin, or nowhere", (direction, expected) => {
    expect(nextBin(at(1, 1), direction, filled, gridLayout([10, 10]))).toBe(expected);
  });
});

describe("a gallery", () => {
  it("has the first axis to the right, the second upwards", () => {
    expect(cornerOf(0, [3, 2], 10)).toEqual([0, 10]);
    expect(cornerOf(5, [3, 2], 10)).toEqual([20, 0]);
  });

  it("shows the filled tiles in the window, sorted from its middle", () => {
    const window = { left: 15, top: 0, width: 15, height: 10 };
    expect(visibleBins([0, 1, 2, 3, 4, 5], [3, 2], 10, window)).toEqual([5, 3]);
    expect(visibleBins([0, 1], [3, 2], 10, window)).toEqual([]);
  });
});
