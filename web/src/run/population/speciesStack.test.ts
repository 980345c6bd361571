import { describe, expect, it } from "vitest";
import { colourOf, extentOf, pathOf, speciesAt, stackOf } from "./SpeciesPlot";

describe("species over time", () => {
  const history = { generation: [1, 2, 3], number: [[0], [0, 2], [2]], members: [[8], [5, 3], [8]] };
  const stack = stackOf(history);

  it("fill the population, the oldest lowest", () => {
    expect(stack.size).toBe(8);
    expect(stack.areas.map(({ number }) => number)).toEqual([0, 2]);
    expect(stack.areas[1]).toEqual({ number: 2, from: [8, 5, 0], to: [8, 8, 8] });
  });

  it("are found at a point, with their size", () => {
    expect(speciesAt(stack, 1, 4)).toEqual([0, 5]);
    expect(speciesAt(stack, 1, 6)).toEqual([2, 3]);
    expect(speciesAt(stack, 1, 9)).toBeNull();
  });

  it("grow from nothing and shrink to nothing", () => {
    expect(extentOf(stack.areas[0]!)).toEqual([0, 2]);
    expect(extentOf({ from: [0, 0, 0, 0, 0], to: [0, 0, 1, 0, 0] })).toEqual([1, 3]);
    const path = pathOf(
      stack.areas[0]!,
      (i) => 10 * i,
      (v) => 8 - v,
    );
    expect(path).toBe("M0.0 0.0L10.0 3.0L20.0 8.0L20.0 8.0L10.0 8.0L0.0 8.0Z");
  });

  it("differ in colour from those that arose beside them", () => {
    const lightness = (number: number) => {
      const [r, g, b] = colourOf(number).match(/\d+/g)!.map(Number) as [number, number, number];
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    for (let number = 0; number < 50; number++) {
      expect(Math.abs(lightness(number) - lightness(number + 1))).toBeGreaterThan(25);
    }
  });
});
