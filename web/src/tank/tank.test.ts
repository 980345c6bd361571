import { describe, expect, it } from "vitest";
import { type PoseStream, decodePoses } from "../decode/poses";
import { header, poseBytes } from "../decode/poses.fixture";
import { STEPS_PER_SECOND } from "../replay/clock";
import { velocityAt } from "../replay/poses";
import { ENTERING, LEAVING, type Swimmer, advance, nearestScale, swimmerAt, withSwimmers } from "./swimmers";

const SIZE = { width: 1000, height: 500 };
/** Steps of the two recorded frames, which are ten steps apart. */
const LOOP = 20;

/** A straight body that moves two cells to the right and four up from its first frame to the second. */
function streamOf(creature: string): PoseStream {
  const stream = decodePoses(poseBytes({ ...header, creature }));
  stream.positions.set([9, 20, 11, 20, 11, 24, 13, 24]);
  return stream;
}

const name = (digit: string) => digit.repeat(64);
const [A, B, C] = ["1", "5", "c"].map((digit) => streamOf(name(digit))) as [
  PoseStream,
  PoseStream,
  PoseStream,
];
const namesOf = (swimmers: readonly Swimmer[]) => swimmers.map(({ creature }) => creature).sort();

describe("the creatures of the tank", () => {
  it("stay where they are, enter and leave as the server's choice changes", () => {
    const first = withSwimmers([], [A, B], SIZE, true);
    expect(namesOf(first)).toEqual([name("1"), name("5")]);
    expect(first.every(({ age, leaving }) => age === ENTERING && leaving === null)).toBe(true);
    const later = withSwimmers(first, [B, C], SIZE, false);
    const find = (digit: string) => later.find(({ creature }) => creature === name(digit))!;
    expect(find("5").position).toEqual(first.find(({ creature }) => creature === name("5"))!.position);
    expect(find("1").leaving).toBe(0);
    expect([find("c").age, find("c").leaving]).toEqual([0, null]);
    expect(namesOf(advance(later, LEAVING + 0.1, 1, SIZE))).toEqual([name("5"), name("c")]);
  });

  it("return if they are chosen again before they have gone", () => {
    const leaving = withSwimmers(withSwimmers([], [A], SIZE, true), [B], SIZE, false);
    const again = withSwimmers(leaving, [A, B], SIZE, false);
    expect(again.map(({ leaving }) => leaving)).toEqual([null, null]);
  });

  it("have room: each starts inside the water, apart from the others", () => {
    const streams = [..."0123456789abcdef"].map((a, i) => streamOf((a + "7b2e"[i % 4]!).repeat(32)));
    const swimmers = withSwimmers([], streams, SIZE, true);
    for (const { position, creature } of swimmers) {
      expect(position[0]).toBeGreaterThan(0);
      expect(position[0]).toBeLessThan(SIZE.width);
      expect(position[1]).toBeGreaterThan(0);
      expect(position[1]).toBeLessThan(SIZE.height);
      const others = swimmers.filter((one) => one.creature !== creature);
      const nearest = Math.min(
        ...others.map((one) => Math.hypot(one.position[0] - position[0], one.position[1] - position[1])),
      );
      expect(nearest).toBeGreaterThan(20);
    }
  });

  it("are drawn with the best in front", () => {
    const swimmers = withSwimmers([], [A, B, C], SIZE, true);
    expect(swimmers.at(-1)!.creature).toBe(name("1"));
    expect(swimmers[0]!.depth).toBeLessThan(swimmers[2]!.depth);
  });
});

describe("a swimmer", () => {
  const alone = (heading: number): Swimmer => ({
    ...withSwimmers([], [A], SIZE, true)[0]!,
    position: [500, 250],
    heading,
    steps: 0,
    depth: 1,
  });

  it("moves as it was recorded, turned by its heading, whatever the frames", () => {
    for (const [heading, [dx, dy]] of [
      [0, [2, -4]],
      [Math.PI / 2, [-4, -2]],
    ] as const) {
      let [one] = [alone(heading)];
      for (let i = 0; i < 10; i++) [one] = advance([one], 1 / STEPS_PER_SECOND, 3, SIZE) as [Swimmer];
      expect(one.position[0]).toBeCloseTo(500 + 3 * dx, 6);
      expect(one.position[1]).toBeCloseTo(250 + 3 * dy, 6);
    }
  });

  it("keeps its mean velocity from the last frame to the first", () => {
    expect(velocityAt(A, 15)).toEqual(velocityAt(A, 5));
    expect(velocityAt(A, LOOP + 5)[1]).toBeCloseTo(0.4, 6);
  });

  it("that leaves over one side comes in over the other, and its trail has a gap", () => {
    const one = { ...alone(0), position: [SIZE.width + 3, 250] as [number, number], age: 10 };
    const [moved] = advance([one], 0.05, 1, SIZE);
    expect(moved!.position[0]).toBeCloseTo(SIZE.width + 3 + 2 - (SIZE.width + 2), 6);
    expect(moved!.trail).toContain(null);
  });

  it("is under a point near it, unless it leaves", () => {
    const one = alone(0);
    expect(swimmerAt([one], [505, 255], 3)).toBe(one);
    expect(swimmerAt([one], [600, 250], 3)).toBe(null);
    expect(swimmerAt([{ ...one, leaving: 0.1 }], [505, 255], 3)).toBe(null);
  });
});

describe("the scale", () => {
  it("gives the median body its size, smaller in a narrow window", () => {
    const wide = nearestScale([A, B, C], 1280);
    expect(2 * wide).toBeGreaterThan(60); // The bodies have a length of two cells.
    expect(nearestScale([A, B, C], 390)).toBeLessThan(wide);
  });
});
