/** Draw the creatures of the tank at one moment, and their trails on a canvas behind; the water is behind both. */

import type { Point } from "../replay/motion";
import { radiusOf, traceBody } from "../replay/poses";
import { type Size, prepare } from "../ui/canvas";
import { ENTERING, LEAVING, type Swimmer, scaleAt } from "./swimmers";

/** Far bodies have the colour of the water, near ones that of the light; the pointed one is warm. */
const [FAR, NEAR, POINTED] = [
  [86, 150, 164],
  [253, 248, 236],
  [255, 206, 130],
] as const;
/** The details with which creatures are drawn. */
interface Style {
  /** A body is drawn several times, from its glow to its core: width and opacity. */
  strokes: readonly (readonly [width: number, opacity: number])[];
  /** Farther bodies have no glow. */
  glowing: number;
  /** Pieces of a trail, each fainter than the next. */
  pieces: number;
  /** Round ends and corners, which thin lines do not need, take a tenth of the time. */
  round: boolean;
}
const STYLE: Style = {
  strokes: [
    [5, 0.06],
    [2.4, 0.16],
    [1, 1],
  ],
  glowing: 0.25,
  pieces: 4,
  round: true,
};
/** For phones, which are slower: in windows narrower than this. */
const [PLAIN, PHONE]: [Style, number] = [
  {
    strokes: [
      [3.4, 0.13],
      [1, 1],
    ],
    glowing: 0.8,
    pieces: 1,
    round: false,
  },
  640,
];
/** Sides of the square in which `traceBody` draws a body, in radii. */
const SIDE = 1 / 0.42;

/** `pointed` is the name of a creature. */
export function drawTank(
  canvas: HTMLCanvasElement,
  size: Size,
  swimmers: readonly Swimmer[],
  nearest: number,
  pointed: string | null,
): void {
  const { strokes, glowing } = styleOf(size);
  const context = prepared(canvas, size);
  for (const one of swimmers) {
    const stroked = one.depth < glowing ? strokes.slice(-1) : strokes;
    drawSwimmer(context, one, nearest, one.creature === pointed, stroked);
  }
}

/** Draw the ways that creatures came. They change slowly: a few times a second is enough. */
export function drawTrails(canvas: HTMLCanvasElement, size: Size, swimmers: readonly Swimmer[]): void {
  const context = prepared(canvas, size);
  for (const one of swimmers) {
    context.strokeStyle = inkOf(one, false);
    drawTrail(context, one, presenceOf(one), styleOf(size).pieces);
  }
}

function prepared(canvas: HTMLCanvasElement, size: Size): CanvasRenderingContext2D {
  const context = prepare(canvas, size);
  const { round } = styleOf(size);
  context.lineJoin = round ? "round" : "bevel";
  context.lineCap = round ? "round" : "butt";
  return context;
}

const styleOf = ({ width }: Size): Style => (width < PHONE ? PLAIN : STYLE);

function drawSwimmer(
  context: CanvasRenderingContext2D,
  one: Swimmer,
  nearest: number,
  pointed: boolean,
  strokes: Style["strokes"],
): void {
  const presence = presenceOf(one);
  const scale = scaleAt(one.depth, nearest);
  context.strokeStyle = inkOf(one, pointed);
  const side = SIDE * scale * radiusOf(one.stream) * (0.4 + 0.6 * presence);
  context.save();
  context.translate(...one.position);
  context.rotate(-one.heading);
  traceBody(context, one.stream, one.steps, [-side / 2, -side / 2, side]);
  const width = (pointed ? 3.4 : 2.6) * (0.5 + 0.5 * one.depth);
  for (const [share, strength] of strokes) {
    context.globalAlpha = presence * strength * (0.35 + 0.65 * one.depth);
    context.lineWidth = share * width;
    context.stroke();
  }
  context.restore();
  if (one.age < ENTERING) drawRipple(context, one, scale);
}

/** Presence from 0 to 1: a creature is small and faint while it enters or leaves. */
function presenceOf({ age, leaving }: Swimmer): number {
  const entering = Math.min(1, age / ENTERING);
  const staying = leaving === null ? 1 : Math.max(0, 1 - leaving / LEAVING);
  return entering * (2 - entering) * staying;
}

/** A ring that widens where a new creature enters. */
function drawRipple(
  context: CanvasRenderingContext2D,
  { age, position, stream }: Swimmer,
  scale: number,
): void {
  const share = age / ENTERING;
  context.globalAlpha = 0.5 * (1 - share) ** 2;
  context.lineWidth = 1.5;
  context.beginPath();
  context.arc(...position, (0.3 + 1.6 * share) * scale * radiusOf(stream), 0, 2 * Math.PI);
  context.stroke();
}

/** The way that it came, fainter the longer ago. */
function drawTrail(context: CanvasRenderingContext2D, one: Swimmer, presence: number, pieces: number): void {
  const points: (Point | null)[] = [...one.trail, one.position];
  for (let piece = 0; piece < pieces; piece++) {
    const first = Math.floor((piece * (points.length - 1)) / pieces);
    const last = Math.floor(((piece + 1) * (points.length - 1)) / pieces);
    context.globalAlpha = presence * (0.03 + 0.2 * one.depth) * ((piece + 1) / pieces) ** 2;
    context.lineWidth = 0.5 + 1.5 * one.depth * ((piece + 1) / pieces);
    context.beginPath();
    // A line along many points is drawn faster than one between each two of them.
    let drawing = false;
    for (let i = first; i <= last; i++) {
      const point = points[i];
      if (point && drawing) context.lineTo(...point);
      else if (point) context.moveTo(...point);
      drawing = !!point;
    }
    context.stroke();
  }
}

function inkOf({ depth }: Swimmer, pointed: boolean): string {
  const colour = pointed ? POINTED : FAR.map((far, i) => Math.round(far + (NEAR[i]! - far) * depth));
  return `rgb(${colour.join(" ")})`;
}
