/** Pointers in live water: they push it, or pull the body. */

import type { Replay } from "../../decode/replay";
import { type Point, meanOf, positionsAt, wrap } from "../../replay/motion";
import type { Pull, Push } from "../../simulate/simulator";

/** The fastest push, in cells a step. */
const FASTEST = 0.05;
/** The distance from a node within which a pull begins: in cells, and in pixels. */
const NEAR = { cells: 1.5, pixels: 14 };

/** Requests of a visitor, which the next steps carry out. */
export interface Wishes {
  pushes: Push[];
  pull: Pull | null;
  /** Files of the inputs of creatures that join. */
  joining: ArrayBuffer[];
}

export const noWishes = (): Wishes => ({ pushes: [], pull: null, joining: [] });

/** The view of the water: the first creature is in its middle. */
export interface View {
  replay: Replay;
  /** Nodes of the first creature. */
  leader: number;
}

type Pointer = Pick<PointerEvent, "clientX" | "clientY" | "movementX" | "movementY">;
type Box = Pick<DOMRect, "left" | "top" | "width">;

/** The place of a pointer, in cells from the middle. */
export function awayOf({ clientX, clientY }: Pointer, box: Box, { replay }: View): Point {
  const [width, height] = replay.header.size;
  const scale = box.width / width;
  return [(clientX - box.left) / scale - width / 2, height / 2 - (clientY - box.top) / scale];
}

/** The push of a pointer that moves while `steps` are taken. */
export function pushOf(pointer: Pointer, box: Box, view: View, steps: number): Push {
  const scale = box.width / view.replay.header.size[0];
  const velocity = [pointer.movementX, -pointer.movementY].map((moved) => {
    const speed = moved / scale / steps;
    return Math.max(-FASTEST, Math.min(FASTEST, speed));
  });
  return { away: awayOf(pointer, box, view), velocity: velocity as Point };
}

/** The node at a pointer; null if none is near. */
export function nodeAt(pointer: Pointer, box: Box, view: View): number | null {
  const [x, y] = awayOf(pointer, box, view);
  const gaps = placesOf(view).map((place) => Math.hypot(place[0] - x, place[1] - y));
  const nearest = gaps.indexOf(Math.min(...gaps));
  const reach = Math.max(NEAR.cells, (NEAR.pixels * view.replay.header.size[0]) / box.width);
  return gaps[nearest]! <= reach ? nearest : null;
}

/** All nodes, in cells from the middle, where the view shows them. */
export function placesOf({ replay, leader }: View): Point[] {
  const [width, height] = replay.header.size;
  const points = positionsAt(replay, 0);
  const [x, y] = meanOf(points.slice(0, leader));
  return points.map((point) => [
    wrap(point[0] - x + width / 2, width) - width / 2,
    wrap(point[1] - y + height / 2, height) - height / 2,
  ]);
}
