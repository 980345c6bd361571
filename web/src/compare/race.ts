/** Creatures side by side: each swims in a lane of its own, from one line, along its own way. */

import type { PoseStream } from "../decode/poses";
import { type Point, BODY_INK } from "../replay/motion";
import { loopOf, radiusOf, traceBody, turnOfLoop, velocityAt } from "../replay/poses";
import { type Size, prepare } from "../ui/canvas";
import { number } from "../ui/format";
import { text } from "./text";

export interface Lane {
  name: string;
  stream: PoseStream;
}

/** Pixels to the left of the start and to the right of the finish. */
const MARGIN = 70;
const TRAIL_POINTS = 60;
const TRAIL_STEPS = 12;
/** Loops that decide the direction of a creature. */
const LOOPS = 2;

/** The way from the start after some steps, in cells, y upwards; the creature swims to the right. */
export function placeAfter(stream: PoseStream, steps: number): Point {
  const way = wayOf(stream);
  return turned(alongWay(way, steps), way.heading);
}

interface Way {
  /** Steps of a loop, and from frame to frame. */
  whole: number;
  every: number;
  /** Places at the frames of the first loop and at its end. */
  places: Point[];
  /** Each loop is turned by this angle from the one before. */
  turn: number;
  /** The angle by which the way is turned so that it leads to the right. */
  heading: number;
}

const ways = new WeakMap<PoseStream, Way>();

function wayOf(stream: PoseStream): Way {
  const known = ways.get(stream);
  if (known) return known;
  const { steps: whole, every } = loopOf(stream);
  const places: Point[] = [[0, 0]];
  for (let frame = 0; frame < Math.round(whole / every); frame++) {
    const [vx, vy] = velocityAt(stream, (frame + 0.5) * every); // Constant from frame to frame.
    const [x, y] = places.at(-1)!;
    places.push([x + every * vx, y + every * vy]);
  }
  const way: Way = { whole, every, places, turn: turnOfLoop(stream), heading: 0 };
  const [x, y] = alongWay(way, LOOPS * whole);
  way.heading = -Math.atan2(y, x);
  ways.set(stream, way);
  return way;
}

/** The place after some steps, in the direction in which the creature was recorded. */
function alongWay({ whole, every, places, turn }: Way, steps: number): Point {
  const loops = Math.floor(steps / whole);
  const end = places.at(-1)!;
  let [x, y] = [0, 0];
  const add = (place: Point, loop: number) => {
    const [dx, dy] = turned(place, loop * turn);
    [x, y] = [x + dx, y + dy];
  };
  for (let loop = 0; loop < loops; loop++) add(end, loop);
  const frames = (steps - loops * whole) / every;
  const before = Math.min(Math.floor(frames), places.length - 2);
  const [a, b] = [places[before]!, places[before + 1]!];
  const share = frames - before;
  add([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])], loops);
  return [x, y];
}

function turned([x, y]: Point, angle: number): Point {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [cos * x - sin * y, sin * x + cos * y];
}

/** Pixels of a cell: the longest body just fits into its lane. */
export function scaleOf(lanes: readonly Lane[], { height }: Size): number {
  const largest = Math.max(...lanes.map(({ stream }) => radiusOf(stream)));
  return (0.42 * height) / lanes.length / largest;
}

/** True once the first one has reached the finish. */
export function isOver(lanes: readonly Lane[], steps: number, size: Size): boolean {
  const scale = scaleOf(lanes, size);
  const track = size.width - 2 * MARGIN;
  return lanes.some(({ stream }) => scale * placeAfter(stream, steps)[0] > track);
}

export function drawRace(canvas: HTMLCanvasElement, size: Size, lanes: readonly Lane[], steps: number): void {
  const context = prepare(canvas, size);
  const scale = scaleOf(lanes, size);
  drawWater(context, size, lanes, scale);
  context.lineJoin = context.lineCap = "round";
  lanes.forEach((lane, i) => {
    const middle = ((i + 0.5) * size.height) / lanes.length;
    drawLane(context, lane, steps, scale, [MARGIN, middle]);
    caption(context, lane, steps, [12, (i * size.height) / lanes.length + 20]);
  });
}

/** Water, lanes, and a line at each length of the longest body. */
function drawWater(
  context: CanvasRenderingContext2D,
  { width, height }: Size,
  lanes: readonly Lane[],
  scale: number,
): void {
  const water = context.createLinearGradient(0, 0, 0, height);
  water.addColorStop(0, "#12586a");
  water.addColorStop(1, "#04202c");
  context.fillStyle = water;
  context.fillRect(0, 0, width, height);
  context.strokeStyle = "rgb(255 255 255 / 0.09)";
  context.lineWidth = 1;
  context.beginPath();
  const unit = scale * Math.max(...lanes.map(({ stream }) => stream.header.length));
  for (let x = MARGIN; x < width; x += unit) {
    context.moveTo(x, 0);
    context.lineTo(x, height);
  }
  for (let i = 1; i < lanes.length; i++) {
    context.moveTo(0, (i * height) / lanes.length);
    context.lineTo(width, (i * height) / lanes.length);
  }
  context.stroke();
}

function drawLane(
  context: CanvasRenderingContext2D,
  { stream }: Lane,
  steps: number,
  scale: number,
  [left, middle]: Point,
): void {
  const at = (moment: number): Point => {
    const [x, y] = placeAfter(stream, moment);
    return [left + scale * x, middle - scale * y];
  };
  context.strokeStyle = BODY_INK.dark;
  context.globalAlpha = 0.35;
  context.lineWidth = 1.5;
  context.beginPath();
  for (let i = TRAIL_POINTS; i >= 0; i--) context.lineTo(...at(Math.max(0, steps - i * TRAIL_STEPS)));
  context.stroke();
  const side = (scale * radiusOf(stream)) / 0.42;
  context.save();
  context.translate(...at(steps));
  context.rotate(-wayOf(stream).heading);
  traceBody(context, stream, steps, [-side / 2, -side / 2, side]);
  for (const [wide, strength] of [
    [9, 0.1],
    [3, 1],
  ] as const) {
    context.globalAlpha = strength;
    context.lineWidth = wide;
    context.stroke();
  }
  context.restore();
  context.globalAlpha = 1;
}

/** The straight distance from the start, in lengths of the body. */
export function lengthsAfter(stream: PoseStream, steps: number): number {
  return Math.hypot(...placeAfter(stream, steps)) / stream.header.length;
}

function caption(
  context: CanvasRenderingContext2D,
  { name, stream }: Lane,
  steps: number,
  [x, y]: Point,
): void {
  context.font = "600 13px system-ui, sans-serif";
  context.fillStyle = "#eaf4f5";
  context.fillText(text.lane(name, number(lengthsAfter(stream, steps), 2)), x, y);
}
