import { describe, expect, it } from "vitest";
import { decodePoses } from "../decode/poses";
import { header, poseBytes } from "../decode/poses.fixture";
import { momentOf, traceBody, tracePath } from "./poses";

/** Two frames, ten steps apart. */
const stream = decodePoses(poseBytes());
const whole = decodePoses(poseBytes({ ...header, strokes: 0 }));

/** The points that are traced in a square of 100 pixels. */
function traced(trace: typeof traceBody, of: typeof stream, steps: number): number[][] {
  const points: number[][] = [];
  const add = (x: number, y: number) => points.push([x, y]);
  const spline = (...[, , , , x, y]: number[]) => add(x!, y!);
  const context = { beginPath: () => {}, arc: () => {}, moveTo: add, lineTo: add, bezierCurveTo: spline };
  trace(context as never, of, steps, [0, 0, 100]);
  return points;
}

describe("the pose at a time", () => {
  it("keeps the pace of the simulation, and repeats two strokes without a jump", () => {
    expect(momentOf(stream, 0)).toEqual([0, 1, 0, 0]);
    expect(momentOf(stream, 5)).toEqual([0, 1, 0.5, 0]);
    expect(momentOf(stream, 15)).toEqual([1, 0, 0.5, 0]);
    expect(momentOf(stream, 20)).toEqual([0, 1, 0, 1]);
  });

  it("starts again after the last frame where the frames are no whole strokes", () => {
    expect(momentOf(whole, 9)).toEqual([0, 1, 0.9, 0]);
    expect(momentOf(whole, 10)).toEqual([0, 1, 0, 1]);
  });
});

describe("a traced body", () => {
  const [a, b] = traced(traceBody, stream, 5);

  it("has its mean position in the middle, and its largest reach within the square", () => {
    expect((a![0]! + b![0]!) / 2).toBeCloseTo(50, 4);
    expect((a![1]! + b![1]!) / 2).toBeCloseTo(50, 4);
    for (const point of [a!, b!]) for (const value of point) expect(Math.abs(value - 50)).toBeLessThan(42);
  });

  it("turns on in the next loop as it turned in the last stroke", () => {
    const turning = decodePoses(poseBytes());
    turning.positions.set([10, 19, 10, 21], 4); // A quarter of a turn from frame to frame.
    const [right, left] = traced(traceBody, turning, 20); // After two of them.
    expect(right![0]).toBeCloseTo(50 + 42, 4);
    expect(left![0]).toBeCloseTo(50 - 42, 4);
    const quarters = traced(traceBody, turning, 30);
    expect(quarters[0]![1]).toBeCloseTo(50 - 42, 4); // Three quarters: the first node is above.
  });

  it("comes along the path of the simulation", () => {
    const still = decodePoses(poseBytes());
    still.positions.set(still.positions.subarray(0, 4), 4); // In place at (10, 20) in both frames.
    // At step 50 of 60, after the moments at steps 0 and 30; the body is 1 cell to each side.
    expect(traced(tracePath, still, 0)).toEqual([
      [50, 50],
      [50 + 42, 50],
      [50, 50],
    ]);
  });
});
