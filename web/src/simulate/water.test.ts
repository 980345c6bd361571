import { describe, expect, it } from "vitest";
import {
  type Plane,
  forced,
  freest,
  pushed,
  quantised,
  shortest,
  sideFor,
  velocities,
  vorticity,
} from "./water";

const SIZE: [number, number] = [16, 12];
const NODE = Float32Array.of(0, 0);
const CELLS = SIZE[0] * SIZE[1];
const still = (): Plane[] => Array.from({ length: 9 }, () => new Float32Array(CELLS));
const total = (plane: Plane) => plane.reduce((sum, value) => sum + value, 0);

/** A plane of a function of x and y. */
const planeOf = (of: (x: number, y: number) => number) =>
  Float32Array.from({ length: CELLS }, (_, cell) => of(Math.floor(cell / SIZE[1]), cell % SIZE[1]));

describe("a force", () => {
  it("is the momentum that the water gains, wherever it acts", () => {
    for (const place of [
      [8, 6],
      [0.3, 11.8],
    ] as [number, number][]) {
      const water = still();
      forced(water, SIZE, place, [0.04, -0.02]);
      const momentum = (axis: 0 | 1) =>
        [1, -1, 0, 0, 1, -1, 1, -1].reduce((sum, cx, i) => {
          const cy = [0, 0, 1, -1, 1, -1, -1, 1][i]!;
          return sum + (axis === 0 ? cx : cy) * total(water[i + 1]!);
        }, 0);
      expect(momentum(0)).toBeCloseTo(0.04, 6);
      expect(momentum(1)).toBeCloseTo(-0.02, 6);
    }
  });
});

describe("a place for another creature", () => {
  it("is the farthest from all nodes, across the edges of the world too", () => {
    expect(freest(Float32Array.of(0, 0, 16, 12), SIZE, NODE, [])).toEqual([8, 6]);
    expect(freest(Float32Array.of(8, 6, 40, 30), SIZE, NODE, [])).toEqual([0, 0]);
    expect(shortest([15, -11], SIZE)).toEqual([-1, 1]);
  });
});

describe("a place between walls", () => {
  // A channel along x, whose walls are the outer rows.
  const channel = planeOf((_, y) => Number(y === 0 || y === SIZE[1] - 1));

  it("is one whose body reaches no wall", () => {
    expect(freest(Float32Array.of(8, 6), SIZE, NODE, channel)).toEqual([0, 3]);
    const across = Float32Array.of(0, -2, 0, 0, 0, 2);
    expect(freest(Float32Array.of(8, 6), SIZE, across, channel)).toEqual([0, 4.5]);
  });

  it("may not be there", () => {
    const across = Float32Array.of(0, -4, 0, 0, 0, 4);
    expect(freest(Float32Array.of(8, 6), SIZE, across, channel)).toBeNull();
    expect(freest(Float32Array.of(8, 6), SIZE, across, [])).not.toBeNull();
  });

  it("needs water that is longer than the body", () => {
    expect(sideFor(Float32Array.of(0, -3, 0, 0, 4, 0))).toBe(5 + 4);
  });
});

describe("a push", () => {
  it("gives the water its velocity and adds no mass", () => {
    const water = still();
    pushed(water, SIZE, [8, 6], [0.03, -0.02]);
    const [x, y] = velocities(water);
    expect(x[8 * SIZE[1] + 6]).toBeCloseTo(0.03, 6);
    expect(y[8 * SIZE[1] + 6]).toBeCloseTo(-0.02, 6);
    expect(water.map(total).reduce((sum, one) => sum + one)).toBeCloseTo(0, 6);
    expect(x[0]).toBe(0);
  });

  it("crosses the edges of the world", () => {
    const [inside, across] = [still(), still()];
    pushed(inside, SIZE, [8, 6], [0.03, 0]);
    pushed(across, SIZE, [-24, 18], [0.03, 0]);
    expect(total(velocities(across)[0])).toBeCloseTo(total(velocities(inside)[0]), 6);
    expect(velocities(across)[0][8 * SIZE[1] + 6]).toBeCloseTo(0.03, 6);
  });
});

describe("a force on the water", () => {
  it("has acted for half a step on its velocity, but on no wall", () => {
    const walls = Int32Array.from({ length: SIZE[0] * SIZE[1] }, (_, cell) => (cell === 3 ? 1 : 0));
    const across = planeOf((x) => 0.001 * x);
    const [x, y] = velocities(still(), { uniform: [0.004, -0.002], across, along: planeOf(() => 0), walls });
    expect(x[8 * SIZE[1] + 6]).toBeCloseTo(0.002 + 0.004, 6);
    expect(y[8 * SIZE[1] + 6]).toBeCloseTo(-0.001, 6);
    expect([x[3], y[3]]).toEqual([0, 0]);
  });
});

describe("the vorticity", () => {
  it("is the slope of a shear flow", () => {
    const wave = (x: number) => 0.05 * Math.sin((2 * Math.PI * x) / SIZE[0]);
    const found = vorticity([planeOf(() => 0), planeOf(wave)], SIZE);
    const slope = 0.05 * Math.sin((2 * Math.PI) / SIZE[0]);
    expect(found[5]).toBeCloseTo(slope, 6);
    expect(vorticity([planeOf((_, y) => 0.01 * y), planeOf(() => 0)], SIZE)[5 * SIZE[1] + 5]).toBeCloseTo(
      -0.01,
    );
  });
});

describe("levels", () => {
  it("span the largest value, and have its scale", () => {
    const [levels, scale] = quantised([Float32Array.of(0.5, -1), Float32Array.of(0, 0.25)]);
    expect([...levels]).toEqual([64, -127, 0, 32]);
    expect(scale).toBe(1);
  });
});
