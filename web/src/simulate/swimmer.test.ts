import { expect, it } from "vitest";
import { type Swimmer, writeRest } from "./swimmer";

const swimmer = {
  numbers: { steps: 5 },
  rest: { "rest angles": Float32Array.of(0, 0, 10, 20, 99), "rest lengths": new Float32Array(5) },
  window: { start: 2, stop: 4 },
} as unknown as Swimmer;

it.each([
  [2, 10],
  [2.25, 12.5],
  // The end of the last stroke leads to its beginning, not to the step behind it.
  [3.5, 15],
  [4, 10],
  [5.75, 12.5],
])("takes at step %s the rest shape of the last strokes, which repeat", (step, expected) => {
  const to = new Float32Array(1);
  expect(writeRest(swimmer, "rest angles", step, to)).toBe(1);
  expect(to[0]).toBeCloseTo(expected);
});
