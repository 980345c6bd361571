/** The creatures of the tank, and how they move on: as recorded, from wherever they are. */

import type { PoseStream } from "../decode/poses";
import { STEPS_PER_SECOND } from "../replay/clock";
import type { Point } from "../replay/motion";
import { radiusOf, velocityAt } from "../replay/poses";
import type { Size } from "../ui/canvas";

export interface Swimmer {
  creature: string;
  stream: PoseStream;
  /** From 0, far away, to 1. */
  depth: number;
  /** Pixels. */
  position: Point;
  /** Radians, counterclockwise. */
  heading: number;
  /** Simulated steps since the first recorded frame. */
  steps: number;
  /** Seconds since it entered, and since it began to leave; null while it stays. */
  age: number;
  leaving: number | null;
  /** Earlier positions, the oldest first; null where it left over one side and came in again. */
  trail: (Point | null)[];
}

/** Seconds in which a creature appears or disappears. */
export const ENTERING = 1.6;
export const LEAVING = 1.2;
/** Points of a trail, and seconds between them. */
const [TRAIL, TRAIL_SECONDS] = [48, 0.16];
/** The size of the farthest creatures relative to the nearest. */
const FARTHEST = 0.55;
/** Pixels of the median body from end to end, among the nearest. */
const BODY = 92;
/** Places among which a creature takes the one with most room. */
const CANDIDATES = 12;

/** Pixels of a cell at a depth. */
export const scaleAt = (depth: number, nearest: number) => nearest * (FARTHEST + (1 - FARTHEST) * depth);

/** Pixels of a cell for the nearest creatures, so that the median body has its size. */
export function nearestScale(streams: readonly PoseStream[], width: number): number {
  const radii = streams.map(radiusOf).sort((a, b) => a - b);
  const body = BODY * Math.min(1, 0.55 + width / 2400);
  return body / (2 * (radii[radii.length >> 1] ?? 1));
}

/** A number from 0 to 1 that belongs to a creature: it is the same whenever it enters. */
export function drawn(creature: string, which: number): number {
  const start = (4 * which) % 60;
  return parseInt(creature.slice(start, start + 4), 16) / 0xffff;
}

/**
 * Keep those that stay, let others leave, and let new ones enter; `order` is that of the server. With
 * `atOnce` they are there or gone without a transition.
 */
export function withSwimmers(
  old: readonly Swimmer[],
  order: readonly PoseStream[],
  size: Size,
  atOnce: boolean,
): Swimmer[] {
  const wanted = new Set(order.map(({ header }) => header.creature));
  const present = new Set(old.map(({ creature }) => creature));
  const kept = atOnce ? old.filter(({ creature }) => wanted.has(creature)) : old;
  const staying = kept.map((one) => ({
    ...one,
    leaving: wanted.has(one.creature) ? null : (one.leaving ?? 0),
  }));
  const found = [...staying];
  order.forEach((stream, place) => {
    const { creature } = stream.header;
    if (present.has(creature)) return;
    const position = roomiest(creature, found, size);
    const { start, stop } = stream.header;
    found.push({
      creature,
      stream,
      depth: Math.sqrt(1 - place / order.length), // The best are near.
      position,
      heading: 2 * Math.PI * drawn(creature, 0),
      steps: drawn(creature, 1) * (stop - start),
      age: atOnce ? ENTERING : 0,
      leaving: null,
      trail: [],
    });
  });
  return found.sort((a, b) => a.depth - b.depth);
}

/** The place farthest from all others, among some that belong to a creature. */
function roomiest(creature: string, others: readonly Swimmer[], { width, height }: Size): Point {
  let [best, room]: [Point, number] = [[width / 2, height / 2], -1];
  for (let i = 0; i < CANDIDATES; i++) {
    const place: Point = [
      (0.04 + 0.92 * drawn(creature, 2 + i)) * width,
      (0.08 + 0.84 * drawn(creature, 3 + i + CANDIDATES)) * height,
    ];
    const distances = others.map(({ position: [x, y] }) => Math.hypot(x - place[0], y - place[1]));
    const nearest = Math.min(Infinity, ...distances);
    if (nearest > room) [best, room] = [place, nearest];
  }
  return best;
}

/** Move all on by some seconds; those that have left are gone. */
export function advance(
  swimmers: readonly Swimmer[],
  seconds: number,
  nearest: number,
  size: Size,
): Swimmer[] {
  for (const one of swimmers) move(one, seconds, nearest, size);
  return swimmers.filter(({ leaving }) => leaving === null || leaving < LEAVING);
}

function move(one: Swimmer, seconds: number, nearest: number, size: Size): void {
  const steps = STEPS_PER_SECOND * seconds;
  const scale = scaleAt(one.depth, nearest);
  const [vx, vy] = velocityAt(one.stream, one.steps);
  const [cos, sin] = [Math.cos(one.heading), Math.sin(one.heading)];
  const moved: Point = [
    one.position[0] + scale * steps * (cos * vx - sin * vy),
    one.position[1] - scale * steps * (sin * vx + cos * vy),
  ];
  const margin = scale * radiusOf(one.stream);
  const inside: Point = [within(moved[0], margin, size.width), within(moved[1], margin, size.height)];
  const due = Math.floor((one.age + seconds) / TRAIL_SECONDS) > Math.floor(one.age / TRAIL_SECONDS);
  if (due) one.trail.push(one.position);
  if (inside[0] !== moved[0] || inside[1] !== moved[1]) one.trail.push(null);
  if (one.trail.length > TRAIL) one.trail.splice(0, one.trail.length - TRAIL);
  one.position = inside;
  one.steps += steps;
  one.age += seconds;
  if (one.leaving !== null) one.leaving += seconds;
}

/** A coordinate that has left over one side comes in over the other, out of sight. */
function within(value: number, margin: number, length: number): number {
  const whole = length + 2 * margin;
  return value < -margin ? value + whole : value > length + margin ? value - whole : value;
}

/** The swimmer under a point: the nearest one of which some part is close. */
export function swimmerAt(swimmers: readonly Swimmer[], [x, y]: Point, nearest: number): Swimmer | null {
  let [found, least]: [Swimmer | null, number] = [null, 1];
  for (const one of swimmers) {
    if (one.leaving !== null) continue;
    const reach = Math.max(24, scaleAt(one.depth, nearest) * radiusOf(one.stream));
    const distance = Math.hypot(x - one.position[0], y - one.position[1]) / reach;
    if (distance < least) [found, least] = [one, distance];
  }
  return found;
}
