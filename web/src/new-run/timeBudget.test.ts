import { expect, it } from "vitest";
import { generationsIn, shownMinutes } from "./TimeBudget";

it.each([
  [2, 0.5, 240],
  [0.001, 0.5, 1],
  [1.5, 7, 12],
  [0, 1, null],
  [-2, 1, null],
  [NaN, 1, null],
])("%s minutes at %s s a generation are %s generations", (minutes, each, generations) => {
  expect(generationsIn(minutes, each)).toBe(generations);
});

it("shows minutes with two digits", () => {
  expect([0.333, 1.234, 12.34, 1234].map(shownMinutes)).toEqual(["0.33", "1.2", "12", "1200"]);
});
