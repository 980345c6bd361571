import { describe, expect, it } from "vitest";
import type { PlanDrawing, PlanSegment } from "../api/types";
import { about, edgesOf, grownOf, kindOf, namedNode, numberPlace, pictureOf } from "./plan";

const gene: PlanSegment = {
  number: 0,
  parent: null,
  place: 0,
  angle: 0,
  nodes: 2,
  curl: 0,
  stiffness: 1,
  mirrored: false,
  copies: 1,
  ring: false,
  grown: 1,
};
const node = (x: number, y: number, segment = 0, copy = 0) => ({ x, y, segment, copy, hand: 1, side: 0 });

/** A root of three nodes, a ring at its end, a segment without room and one attached to it. */
const plan: PlanDrawing = {
  nodes: [node(-1, 0), node(0, 0), node(1, 0), node(2, 1, 1), node(3, 0, 1), node(2, -1, 1)],
  edges: [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 4],
    [4, 5],
    [5, 2],
  ],
  segments: [
    gene,
    { ...gene, parent: 0, place: 1, nodes: 3, ring: true },
    { ...gene, parent: 0, place: 0.5, angle: 90, curl: -20, mirrored: true, copies: 3, grown: 0 },
    { ...gene, parent: 2, grown: 0 },
  ],
};

describe("a body plan", () => {
  it("is drawn with y upwards, within its margins", () => {
    const { width, height, scale, at } = pictureOf(plan);
    expect(at[3]![1]).toBeLessThan(at[5]![1]);
    expect(at[1]![0] - at[0]![0]).toBeCloseTo(scale);
    for (const [x, y] of at) expect(x > 0 && x < width && y > 0 && y < height).toBe(true);
  });

  it("gives the edge that closes a ring to the ring", () => {
    expect(edgesOf(plan, 0)).toEqual([
      [0, 1],
      [1, 2],
    ]);
    expect(edgesOf(plan, 1)).toHaveLength(4);
  });

  it("numbers a segment outside the middle of its first copy, unless it has not grown", () => {
    expect(namedNode(plan, 1)).toBe(4);
    const picture = pictureOf(plan);
    const { x, y } = numberPlace(plan, picture, 1)!;
    expect(x).toBeGreaterThan(picture.at[4]![0]);
    expect(Math.hypot(x - picture.at[4]![0], y - picture.at[4]![1])).toBeCloseTo(15);
    expect(numberPlace(plan, picture, 2)).toBeNull();
  });

  it("numbers a segment away from a branch", () => {
    expect(namedNode(plan, 0)).toBe(1);
    const branched: PlanDrawing = { ...plan, edges: [...plan.edges, [1, 5]] };
    expect(namedNode(branched, 0)).toBe(0);
  });

  it("says why a segment has not grown", () => {
    expect(plan.segments.map((segment) => grownOf(segment, plan))).toEqual([
      "1",
      "1",
      "no room",
      "no parent",
    ]);
  });

  it("tells the genes of a segment that have an effect", () => {
    expect(kindOf({ ...gene, mirrored: true, copies: 2 })).toBe("");
    expect(about(0, plan)).toBe("Segment 1 (root): 2 nodes, curl 0°, stiffness 1, 1 in the body.");
    expect(about(1, plan)).toContain("at 100 % of segment 1 (root), angle 0°, stiffness 1, ring, 1 in");
    expect(about(2, plan)).toContain("angle 90°, curl −20°, stiffness 1, mirrored, 3 copies, no room.");
  });
});
