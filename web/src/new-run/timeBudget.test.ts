import { expect, it } from "vitest";
import { generationsIn, paceOf, shownMinutes } from "./SpecView";

it.each([
  [2, 0, 0.5, 240],
  [2, 20, 0.5, 200],
  [0.001, 0, 0.5, 1],
  [0.1, 20, 0.5, 1],
  [1.5, 0, 7, 12],
  [0, 0, 1, null],
  [-2, 0, 1, null],
  [NaN, 0, 1, null],
])(
  "%s minutes with %s s at the start and %s s a generation are %s generations",
  (minutes, startup, each, found) => {
    expect(generationsIn(minutes, { startup, each })).toBe(found);
  },
);

it("the start is counted once, however many generations were estimated", () => {
  const estimated = (generations: number) => ({
    seconds: 8 + 0.2 * generations,
    cell_steps: 1e6 * generations,
    speed: { device: "cpu", runs: 3, cell_steps_per_second: 5e6, low: 0, high: 0 },
  });
  for (const generations of [10, 30, 300]) {
    const pace = paceOf(estimated(generations), generations)!;
    expect(generationsIn(10, pace)).toBe(2960);
    expect(pace.startup).toBeCloseTo(8);
  }
  expect(paceOf({ ...estimated(10), seconds: null, speed: null }, 10)).toBeNull();
});

it("shows minutes with two digits", () => {
  expect([0.333, 1.234, 12.34, 1234].map(shownMinutes)).toEqual(["0.33", "1.2", "12", "1200"]);
});
