import { describe, expect, it } from "vitest";
import { fromZero, logAround, positionOf, ticksOf, valueAt } from "./scale";

describe("an axis", () => {
  it("has decades of equal length on a log scale", () => {
    const scale = { log: true, low: 0.01, high: 100 };
    expect([0.01, 0.1, 1, 100].map((value) => positionOf(scale, value))).toEqual([0, 0.25, 0.5, 1]);
    expect(positionOf({ log: false, low: -1, high: 3 }, 0)).toBe(0.25);
  });

  it("has room for all values and starts at zero unless some are negative", () => {
    expect(fromZero([1, 4])).toMatchObject({ low: 0 });
    expect(fromZero([-1, 4]).low).toBeLessThan(-1);
    const { low, high } = logAround([0.001, 2, 0]);
    expect([low > 0, low < 0.001, high > 2]).toEqual([true, true, true]);
  });

  it("has ticks within less than a decade", () => {
    expect(ticksOf(logAround([0.3]), 8)).toEqual([0.24, 0.26, 0.28, 0.3, 0.32, 0.34, 0.36]);
    expect(ticksOf({ log: true, low: 8, high: 11 }, 3)).toEqual([8, 9, 10, 11]);
  });

  it("has as many round ticks as there is room for", () => {
    const wide = { log: true, low: 0.0009, high: 2.2 };
    expect(ticksOf(wide, 12)).toEqual([0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2]);
    expect(ticksOf(wide, 5)).toEqual([0.001, 0.01, 0.1, 1]);
    expect(ticksOf(wide, 2)).toEqual([0.001, 0.1]);
    expect(ticksOf({ log: false, low: 0, high: 1.07 }, 6)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
  });

  it("has whole decades as ticks of a wide logarithmic scale", () => {
    const scale = { log: true, low: 1e-4, high: 1e2 };
    const made = ticksOf(scale, 7);
    expect(made.map((value) => Number((6 * positionOf(scale, value)).toFixed(9)))).toEqual([
      0, 1, 2, 3, 4, 5, 6,
    ]);
    made.forEach((value, k) => expect(value).toBeCloseTo(10 ** (k - 4), 12));
  });

  it("has round ticks on a linear scale, no more than asked for", () => {
    const scale = { log: false, low: 0, high: 0.15 };
    expect(ticksOf(scale, 6)).toEqual([0, 0.05, 0.1, 0.15]);
    expect(positionOf(scale, 0.15)).toBeCloseTo(1, 12);
  });

  it("has an inverse", () => {
    for (const log of [true, false]) {
      const scale = { log, low: 2, high: 8 };
      expect(positionOf(scale, valueAt(scale, 0.3))).toBeCloseTo(0.3, 12);
    }
    expect(ticksOf({ log: true, low: 2, high: 8 }, 6)).toEqual([2, 5]);
  });
});
