/** Draw the body of a pose stream, with its mean position in the middle. */

import type { PoseStream } from "../decode/poses";
import { type Point, chainsOf, splineOf } from "./motion";

/** In smaller squares, in pixels, straight edges cannot be told from a spline and are drawn faster. */
const SMOOTH_SIDE = 80;
/** Shorter lines, in pixels, are partly left out. */
const SHORTEST = 3;

interface Shape {
  chains: number[][];
  /** Mean positions (frames, 2). */
  means: Float32Array;
  /** Positions (frames, nodes, 2) relative to the mean position. */
  offsets: Float32Array;
  /** The largest distance of a node from the mean position. */
  radius: number;
  /** The angle that the body turns by while its frames play once. */
  turn: number;
}

const cache = new WeakMap<PoseStream, Shape>();

function shapeOf(stream: PoseStream): Shape {
  const known = cache.get(stream);
  if (known) return known;
  const { frames, nodes, edges } = stream.header;
  const offsets = stream.positions.slice();
  const means = new Float32Array(2 * frames);
  let radius = 0;
  for (let frame = 0; frame < frames; frame++) {
    const values = offsets.subarray(2 * frame * nodes, 2 * (frame + 1) * nodes);
    for (let i = 0; i < values.length; i++) means[2 * frame + (i % 2)]! += values[i]! / nodes;
    for (let i = 0; i < values.length; i++) values[i]! -= means[2 * frame + (i % 2)]!;
    for (let i = 0; i < values.length; i += 2)
      radius = Math.max(radius, Math.hypot(values[i]!, values[i + 1]!));
  }
  const shape = {
    chains: chainsOf(edges),
    means,
    offsets,
    radius: radius || 1,
    turn: turnOf(stream, offsets),
  };
  cache.set(stream, shape);
  return shape;
}

/** Twice the turn from the end of the first stroke to the end of the second; 0 without strokes. */
function turnOf({ header: { frames, nodes, strokes } }: PoseStream, offsets: Float32Array): number {
  if (strokes === 0) return 0;
  const [first, last] = [frames / 2 - 1, frames - 1].map((frame) => 2 * frame * nodes) as Point;
  let [cross, dot] = [0, 0];
  for (let i = 0; i < 2 * nodes; i += 2) {
    const [ax, ay] = [offsets[first + i]!, offsets[first + i + 1]!];
    const [bx, by] = [offsets[last + i]!, offsets[last + i + 1]!];
    cross += ax * by - ay * bx;
    dot += ax * bx + ay * by;
  }
  return 2 * Math.atan2(cross, dot);
}

/** Two frames, the share of the way between them, and how often all frames have been played. */
type Moment = readonly [before: number, after: number, share: number, loops: number];

/** The steps from frame to frame, and those of all frames, after which they repeat. */
export function loopOf({ header: { frames, start, stop, strokes } }: PoseStream): {
  every: number;
  steps: number;
} {
  const every = (stop - start) / frames || 1;
  return { every, steps: every * Math.max(1, strokes > 0 ? frames : frames - 1) };
}

/** The frames around a time in steps; strokes repeat, and other frames start again after the last. */
export function momentOf(stream: PoseStream, steps: number): Moment {
  const { every, steps: loop } = loopOf(stream);
  const time = (steps % loop) / every;
  const before = Math.floor(time);
  return [before, (before + 1) % stream.header.frames, time - before, Math.floor(steps / loop)];
}

/** A point of consecutive (frame, point, 2) values. */
const pointAt = (values: Float32Array, index: number): Point => [values[2 * index]!, values[2 * index + 1]!];

const between = (a: Point, b: Point, share: number): Point => [
  (1 - share) * a[0] + share * b[0],
  (1 - share) * a[1] + share * b[1],
];

function rotation(angle: number): (point: Point) => Point {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return ([x, y]) => [cos * x - sin * y, sin * x + cos * y];
}

/** The largest distance of a node from the mean position, in cells. */
export const radiusOf = (stream: PoseStream): number => shapeOf(stream).radius;

/** The angle that the body turns by while its frames play once. */
export const turnOfLoop = (stream: PoseStream): number => shapeOf(stream).turn;

/** The velocity of the mean position, in cells a step, some steps after the first frame. */
export function velocityAt(stream: PoseStream, steps: number): Point {
  const { means, turn } = shapeOf(stream);
  const { frames } = stream.header;
  const [before, after, , loops] = momentOf(stream, steps);
  // Nothing is recorded from the last frame to the first, so the body has its mean velocity.
  const [first, last] = after > before ? [before, after] : [0, frames - 1];
  const between = loopOf(stream).every * (last - first);
  if (!(between > 0)) return [0, 0];
  const [a, b] = [pointAt(means, first), pointAt(means, last)];
  return rotation(loops * turn)([(b[0] - a[0]) / between, (b[1] - a[1]) / between]);
}

type Square = readonly [left: number, top: number, side: number];

/** The path that bodies are traced on. */
type Path = Pick<CanvasRenderingContext2D, "beginPath" | "moveTo" | "lineTo" | "bezierCurveTo" | "arc">;

/** Trace the body some steps after its first frame, in the middle of a square; it turns on in each loop. */
export function traceBody(context: Path, stream: PoseStream, steps: number, [left, top, side]: Square): void {
  const { chains, offsets, radius, turn } = shapeOf(stream);
  const { nodes } = stream.header;
  const [before, after, share, loops] = momentOf(stream, steps);
  const scale = (0.42 * side) / radius;
  // Both frames are turned and weighed at once, without an array for each point: pages draw hundreds.
  const angle = loops * turn;
  const onward = after > before ? angle : angle + turn;
  const [cos, sin] = [(1 - share) * scale * Math.cos(angle), (1 - share) * scale * Math.sin(angle)];
  const [nextCos, nextSin] = [share * scale * Math.cos(onward), share * scale * Math.sin(onward)];
  const [i0, j0] = [2 * before * nodes, 2 * after * nodes];
  const across = (node: number) => {
    const [i, j] = [i0 + 2 * node, j0 + 2 * node];
    const x = cos * offsets[i]! - sin * offsets[i + 1]! + nextCos * offsets[j]! - nextSin * offsets[j + 1]!;
    return left + side / 2 + x;
  };
  const down = (node: number) => {
    const [i, j] = [i0 + 2 * node, j0 + 2 * node];
    const y = sin * offsets[i]! + cos * offsets[i + 1]! + nextSin * offsets[j]! + nextCos * offsets[j + 1]!;
    return top + side / 2 - y;
  };
  context.beginPath();
  for (const chain of chains) {
    context.moveTo(across(chain[0]!), down(chain[0]!));
    if (side < SMOOTH_SIDE) {
      const stride = Math.max(1, Math.floor((SHORTEST * chain.length) / (0.84 * side)));
      for (let k = stride; k < chain.length - 1; k += stride)
        context.lineTo(across(chain[k]!), down(chain[k]!));
      context.lineTo(across(chain.at(-1)!), down(chain.at(-1)!));
    } else {
      const points = chain.map((node): Point => [across(node), down(node)]);
      for (const [a, b, end] of splineOf(points)) context.bezierCurveTo(...a, ...b, ...end);
    }
  }
}

/** Trace the path of the mean position from a circle at its start to now, in the same square. */
export function tracePath(context: Path, stream: PoseStream, steps: number, [left, top, side]: Square): void {
  const { means, radius, turn } = shapeOf(stream);
  const { start, stop, frames, moments, steps: whole } = stream.header;
  const [before, after, share, loops] = momentOf(stream, steps);
  const onward = after > before ? share : 0; // The path does not lead from the last frame to the first.
  const [meanX, meanY] = between(pointAt(means, before), pointAt(means, after), onward);
  const turned = rotation(loops * turn);
  const time = start + ((stop - start) * (before + 1 + onward)) / frames;
  const scale = (0.42 * side) / radius;
  const place = (i: number): Point => {
    const [x, y] = turned([stream.path[2 * i]! - meanX, stream.path[2 * i + 1]! - meanY]);
    return [left + side / 2 + scale * x, top + side / 2 - scale * y];
  };
  context.beginPath();
  context.arc(...place(0), 3, 0, 2 * Math.PI);
  context.moveTo(...place(0));
  for (let i = 1; i < moments && i * whole < time * (moments - 1); i++) context.lineTo(...place(i));
  context.lineTo(left + side / 2, top + side / 2);
}
