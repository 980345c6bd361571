import { describe, expect, it } from "vitest";
import { type Point, bodiesOf, chainsOf, meanOf, positionsAt, splineOf } from "./motion";

describe("motion", () => {
  const replay = {
    header: { frames: 2, nodes: 2 },
    positions: Float32Array.from([0, 0, 2, 0, 1, 2, 3, 2]),
  };

  it("interpolates between recorded frames and stops at the last", () => {
    expect(positionsAt(replay, 0.5)).toEqual([
      [0.5, 1],
      [2.5, 1],
    ]);
    expect(meanOf(positionsAt(replay, 1))).toEqual([2, 2]);
  });

  it.each([
    ["a chain", "01 12 23", "0123"],
    ["a closed ring", "01 12 20", "0120"],
    ["the arms of a star", "01 02 03", "01 02 03"],
    ["two bodies", "01 23", "01 23"],
  ])("draws %s", (_, edges, chains) => {
    const pairs = edges.split(" ").map((edge) => [Number(edge[0]), Number(edge[1])] as const);
    expect(chainsOf(pairs).map((chain) => chain.join(""))).toEqual(chains.split(" "));
  });

  it("tells bodies apart, whatever joins their chains", () => {
    const star = [0, 1, 2].map((arm) => [9, arm] as const);
    const bodies = bodiesOf([...star, [3, 4], [4, 5]]);
    expect(bodies.map((body) => [...new Set(body.flat())].sort())).toEqual([
      [0, 1, 2, 9],
      [3, 4, 5],
    ]);
  });

  it("goes through every node, and straight where the nodes are in line", () => {
    const line: Point[] = [
      [0, 0],
      [1, 1],
      [2, 2],
    ];
    const pieces = splineOf(line);
    expect(pieces.map(([, , end]) => end)).toEqual(line.slice(1));
    for (const [a, b] of pieces) for (const [x, y] of [a, b]) expect(y).toBeCloseTo(x, 12);
  });
});
