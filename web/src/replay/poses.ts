/** Draw the body of a pose stream, with its mean position in the middle. */

import type { PoseStream } from "../decode/poses";
import { type Point, chainsOf, splineOf } from "./motion";

/** In smaller squares, in pixels, straight edges cannot be told from a spline and are drawn faster. */
const SMOOTH_SIDE = 150;

interface Shape {
  chains: number[][];
  /** Mean positions (frames, 2). */
  means: Float32Array;
  /** Positions (frames, nodes, 2) relative to the mean position. */
  offsets: Float32Array;
  /** The largest distance of a node from the mean position. */
  radius: number;
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
  const shape = { chains: chainsOf(edges), means, offsets, radius: radius || 1 };
  cache.set(stream, shape);
  return shape;
}

/** Two frames, and the share of the way between them. */
type Moment = readonly [before: number, after: number, share: number];

/** The frames around a time in steps; strokes repeat, and other frames start again after the last. */
export function momentOf({ header }: PoseStream, steps: number): Moment {
  const { frames, start, stop, strokes } = header;
  const every = (stop - start) / frames || 1;
  const time = (steps / every) % Math.max(1, strokes > 0 ? frames : frames - 1);
  const before = Math.floor(time);
  return [before, (before + 1) % frames, time - before];
}

/** A point of consecutive (frame, point, 2) values at a moment. */
function at(values: Float32Array, points: number, point: number, [before, after, share]: Moment): Point {
  const [a, b] = [2 * (before * points + point), 2 * (after * points + point)];
  const between = (k: number) => (1 - share) * values[a + k]! + share * values[b + k]!;
  return [between(0), between(1)];
}

type Square = readonly [left: number, top: number, side: number];

/** Trace the body some steps after its first frame, in the middle of a square. */
export function traceBody(
  context: CanvasRenderingContext2D,
  stream: PoseStream,
  steps: number,
  [left, top, side]: Square,
): void {
  const { chains, offsets, radius } = shapeOf(stream);
  const { nodes } = stream.header;
  const moment = momentOf(stream, steps);
  const scale = (0.42 * side) / radius;
  const place = (node: number): Point => {
    const [x, y] = at(offsets, nodes, node, moment);
    return [left + side / 2 + scale * x, top + side / 2 - scale * y];
  };
  context.beginPath();
  for (const chain of chains) {
    const points = chain.map(place);
    context.moveTo(...points[0]!);
    if (side < SMOOTH_SIDE) for (const point of points.slice(1)) context.lineTo(...point);
    else for (const [a, b, end] of splineOf(points)) context.bezierCurveTo(...a, ...b, ...end);
  }
}

/** Trace the path of the mean position from a circle at its start to now, in the same square. */
export function tracePath(
  context: CanvasRenderingContext2D,
  stream: PoseStream,
  steps: number,
  [left, top, side]: Square,
): void {
  const { means, radius } = shapeOf(stream);
  const { start, stop, frames, moments, steps: whole } = stream.header;
  const [before, after, share] = momentOf(stream, steps);
  const onward = after > before ? share : 0; // The path does not lead from the last frame to the first.
  const [x, y] = at(means, 1, 0, [before, after, onward]);
  const time = start + ((stop - start) * (before + 1 + onward)) / frames;
  const scale = (0.42 * side) / radius;
  const place = (i: number): Point => [
    left + side / 2 + scale * (stream.path[2 * i]! - x),
    top + side / 2 - scale * (stream.path[2 * i + 1]! - y),
  ];
  context.beginPath();
  context.arc(...place(0), 3, 0, 2 * Math.PI);
  context.moveTo(...place(0));
  for (let i = 1; i < moments && i * whole < time * (moments - 1); i++) context.lineTo(...place(i));
  context.lineTo(left + side / 2, top + side / 2);
}
