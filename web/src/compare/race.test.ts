import { describe, expect, it } from "vitest";
import type { Creature } from "../api/types";
import { decodePoses } from "../decode/poses";
import { header, poseBytes } from "../decode/poses.fixture";
import { commonGenes } from "./CreaturesPage";
import { isOver, lengthsAfter, placeAfter, scaleOf } from "./race";

/** Two frames, ten steps apart; the middle of the body moves from the first to the second. */
function moving(dx: number, dy: number) {
  const stream = decodePoses(poseBytes(header));
  stream.positions.set([9, 20, 11, 20, 9 + dx, 20 + dy, 11 + dx, 20 + dy]);
  return stream;
}

describe("a creature in its lane", () => {
  it("swims to the right whatever the direction in which it was recorded", () => {
    for (const [dx, dy] of [
      [5, 0],
      [0, 5],
      [-3, 4],
    ] as const) {
      const [x, y] = placeAfter(moving(dx, dy), 10);
      expect(x).toBeCloseTo(5, 5);
      expect(y).toBeCloseTo(0, 5);
    }
  });

  it("goes on with its mean velocity in further loops, and between frames", () => {
    const stream = moving(3, 4);
    for (const steps of [0, 5, 10, 25, 200]) expect(placeAfter(stream, steps)[0]).toBeCloseTo(steps / 2, 4);
    expect(lengthsAfter(stream, 40)).toBeCloseTo(20 / header.length, 4);
  });

  it("comes back to its start if it turns by half a turn in each loop", () => {
    const stream = moving(0, 0);
    stream.positions.set([13, 19, 13, 21], 4); // A quarter of a turn a stroke, of which a loop has two.
    const loop = 20;
    expect(Math.hypot(...placeAfter(stream, loop))).toBeGreaterThan(5);
    expect(Math.hypot(...placeAfter(stream, 2 * loop))).toBeCloseTo(0, 4);
  });
});

describe("lanes", () => {
  const lanes = [moving(1, 0), moving(5, 0)].map((stream, i) => ({ name: String(i), stream }));
  const size = { width: 640, height: 240 };

  it("have one scale, in which the largest body fits", () => {
    const scale = scaleOf(lanes, size);
    expect(2 * scale).toBeLessThanOrEqual(120); // Both bodies have a radius of one cell.
    expect(2 * scale).toBeGreaterThan(60);
  });

  it("end when the fastest has arrived", () => {
    const track = (640 - 140) / scaleOf(lanes, size);
    expect(isOver(lanes, (track / 5) * 10 - 1, size)).toBe(false);
    expect(isOver(lanes, (track / 5) * 10 + 1, size)).toBe(true);
  });
});

describe("genes in common", () => {
  const creature = (innovation: number[] | null) =>
    ({
      identity: { genome: innovation ? { connections: { innovation } } : { values: "" } },
    }) as unknown as Creature;

  it("are those with innovation numbers of the first", () => {
    const found = commonGenes([creature([1, 2, 3]), creature([2, 3, 4, 5]), creature(null)]);
    expect(found).toEqual(["3 of 3", "2 of 4", "–"]);
  });

  it("are told of networks only, and of two at least", () => {
    expect(commonGenes([creature(null), creature([1])])).toBe(null);
    expect(commonGenes([creature([1])])).toBe(null);
  });
});
