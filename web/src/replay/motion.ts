/** Positions between recorded frames, and lines through them. */

import type { Replay } from "../decode/replay";

export type Point = [number, number];

/** Node positions at a fractional frame, unwrapped. */
export function positionsAt(
  { header, positions }: Pick<Replay, "positions"> & { header: Pick<Replay["header"], "nodes" | "frames"> },
  time: number,
): Point[] {
  const { nodes, frames } = header;
  const before = Math.max(0, Math.min(frames - 1, Math.floor(time)));
  const after = Math.min(frames - 1, before + 1);
  const t = Math.min(1, Math.max(0, time - before));
  return Array.from({ length: nodes }, (_, node) => {
    const [a, b] = [2 * (before * nodes + node), 2 * (after * nodes + node)];
    const between = (k: number) => (1 - t) * positions[a + k]! + t * positions[b + k]!;
    return [between(0), between(1)];
  });
}

/** A coordinate within a world that repeats. */
export function wrap(value: number, size: number): number {
  return ((value % size) + size) % size;
}

export function meanOf(points: Point[]): Point {
  const sum = points.reduce(([x, y], point) => [x + point[0], y + point[1]], [0, 0]);
  return [sum[0] / points.length, sum[1] / points.length];
}

/** The body's edges as long chains of nodes, which end at tips and branches. */
export function chainsOf(edges: readonly (readonly [number, number])[]): number[][] {
  const neighbours = new Map<number, Set<number>>();
  const neighboursOf = (node: number) => neighbours.get(node) ?? neighbours.set(node, new Set()).get(node)!;
  for (const [a, b] of edges) {
    neighboursOf(a).add(b);
    neighboursOf(b).add(a);
  }
  const through = new Set([...neighbours].filter(([, to]) => to.size === 2).map(([node]) => node));
  const used = new Set<string>();
  const chains: number[][] = [];
  const trace = (from: number) => {
    for (const first of neighbours.get(from)!) {
      const chain = [from];
      let [last, next] = [from, first];
      while (!used.has(key(last, next))) {
        used.add(key(last, next));
        chain.push(next);
        if (!through.has(next)) break;
        const onward = [...neighbours.get(next)!].find((node) => node !== last)!;
        [last, next] = [next, onward];
      }
      if (chain.length > 1) chains.push(chain);
    }
  };
  for (const node of neighbours.keys()) if (!through.has(node)) trace(node);
  for (const node of through) trace(node); // Rings have no tip.
  return chains;
}

/** The chains of each body, which are connected. */
export function bodiesOf(edges: readonly (readonly [number, number])[]): number[][][] {
  const bodies: number[][][] = [];
  for (const chain of chainsOf(edges)) {
    const touching = bodies.filter((body) => body.flat().some((node) => chain.includes(node)));
    for (const body of touching) bodies.splice(bodies.indexOf(body), 1);
    bodies.push([...touching.flat(), chain]);
  }
  return bodies;
}

function key(a: number, b: number): string {
  return a < b ? `${a} ${b}` : `${b} ${a}`;
}

/** Bézier pieces of the Catmull-Rom spline through the points: control, control, end. */
export function splineOf(points: Point[]): [Point, Point, Point][] {
  const [first, last] = [points[0]!, points.at(-1)!];
  const closed = points.length > 2 && first[0] === last[0] && first[1] === last[1];
  const at = (i: number): Point => {
    if (i >= 0 && i < points.length) return points[i]!;
    if (closed) return i < 0 ? points.at(-2)! : points[1]!;
    return i < 0 ? first : last;
  };
  return points.slice(0, -1).map((_, i) => {
    const [p0, p1, p2, p3] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    const sixth = (from: Point, a: Point, b: Point, sign: number): Point => [
      from[0] + (sign * (b[0] - a[0])) / 6,
      from[1] + (sign * (b[1] - a[1])) / 6,
    ];
    return [sixth(p1, p0, p2, 1), sixth(p2, p1, p3, -1), p2];
  });
}

/** The colour of a body on a background of each theme. */
export const BODY_INK = { light: "#12222c", dark: "#fdf8ec" };
