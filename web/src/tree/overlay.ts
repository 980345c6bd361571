/** The moving parts above the picture of a tree: bodies, a line of descent, the axis. */

import { type Phylogeny, NONE, nameAt } from "../decode/phylogeny";
import type { PoseStream } from "../decode/poses";
import { ticksOf } from "../charts/plot/scale";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";
import type { Size, Theme } from "../ui/canvas";
import { count, number, shortId } from "../ui/format";
import type { Landmark } from "./landmarks";
import type { TreeLayout } from "./layout";
import { lineOf, otherParents } from "./nearest";
import { type Context, INKS, traceEdge } from "./paint";
import type { Shades } from "./shades";
import { text } from "./text";
import { type Place, type Scales, type View, MARGIN, placeOf } from "./view";

export interface Overlay {
  tree: Phylogeny;
  layout: TreeLayout;
  view: View;
  scales: Scales;
  size: Size;
  at: number;
  theme: Theme;
  shades: Shades;
  landmarks: readonly Landmark[];
  poses: ReadonlyMap<string, PoseStream>;
  /** The creature that is pointed at or selected, or `NONE`. */
  focus: number;
  /** Simulated steps so far. */
  steps: number;
  /** The time at which each run began. */
  begins: readonly number[];
}

const FONT = "12px system-ui, sans-serif";
const AXIS = 24;
const MAX_TICKS = 9;
/** Pixels at the right end of the axis, for its name. */
const NAMED = 96;

/** Draw over a cleared canvas. */
export function drawOverlay(context: Context, scene: Overlay): void {
  context.font = FONT;
  context.lineJoin = context.lineCap = "round";
  const place = (i: number) =>
    placeOf({ time: scene.tree.time[i]!, row: scene.layout.row[i]! }, scene.scales, scene.view, scene.size);
  drawBoundaries(context, scene);
  const line = scene.focus === NONE ? [] : lineOf(scene.layout, scene.focus);
  if (line.length > 0) drawLine(context, scene, line, place);
  for (const landmark of scene.landmarks) drawBody(context, scene, landmark, place(landmark.creature));
  drawAxis(context, scene);
  if (scene.focus !== NONE) drawLabel(context, scene, place(scene.focus));
}

/** Lines at the beginnings of several runs, and at the time shown. */
function drawBoundaries(context: Context, scene: Overlay): void {
  const { tree, view, scales, size, theme, begins, at } = scene;
  const xOf = (time: number) => placeOf({ time, row: 0 }, scales, view, size)[0];
  context.lineWidth = 1;
  context.strokeStyle = context.fillStyle = INKS[theme].quiet;
  context.textBaseline = "top";
  context.textAlign = "left";
  if (begins.length > 1) {
    begins.forEach((begin, k) => {
      const x = xOf(begin);
      dashed(context, x, size.height - AXIS);
      context.fillText(shortId(tree.runs[k]!), x + 5, 5);
    });
  }
  if (at < view.time + size.width / 2 / scales.x) dashed(context, xOf(at), size.height - AXIS);
}

function dashed(context: Context, x: number, height: number): void {
  context.setLineDash([2, 4]);
  context.beginPath();
  context.moveTo(x, 0);
  context.lineTo(x, height);
  context.stroke();
  context.setLineDash([]);
}

/** The line of first parents in the ink of the page; links to second parents faintly. */
function drawLine(
  context: Context,
  { tree, layout, theme }: Overlay,
  line: readonly number[],
  place: (i: number) => Place,
): void {
  const { ink, ground } = INKS[theme];
  const trace = (child: number, parent: number) => traceEdge(context, ...place(parent), ...place(child));
  context.beginPath();
  for (const [child, parent] of otherParents(tree, layout, line)) trace(child, parent);
  context.strokeStyle = ink;
  context.globalAlpha = 0.4;
  context.lineWidth = 1.2;
  context.setLineDash([3, 4]);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
  context.beginPath();
  for (let k = 1; k < line.length; k++) trace(line[k - 1]!, line[k]!);
  for (const [colour, width] of [
    [ground, 6],
    [ink, 2.4],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
  context.fillStyle = ink;
  for (const i of line) {
    const [x, y] = place(i);
    context.beginPath();
    context.arc(x, y, 2.6, 0, 2 * Math.PI);
    context.fill();
  }
}

/** A creature in a drop of water, with a rim in its colour; without a pose stream there is no drop. */
function drawBody(
  context: Context,
  { tree, theme, shades, poses, focus, steps }: Overlay,
  { creature, side }: Landmark,
  [x, y]: Place,
): void {
  const stream = poses.get(nameAt(tree, creature));
  if (!stream) return;
  const { ground, ink } = INKS[theme];
  context.beginPath();
  context.arc(x, y, side / 2, 0, 2 * Math.PI);
  context.fillStyle = ground;
  context.globalAlpha = 0.95;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = creature === focus ? ink : shades.colours[shades.shade[creature]!]!;
  context.lineWidth = creature === focus ? 2.4 : 1.5;
  context.stroke();
  const inner = side * 0.86;
  traceBody(context, stream, steps, [x - inner / 2, y - inner / 2, inner]);
  context.strokeStyle = BODY_INK[theme];
  context.lineWidth = Math.max(1.3, side / 34);
  context.stroke();
}

function drawAxis(context: Context, { view, scales, size, theme }: Overlay): void {
  const { ground, quiet } = INKS[theme];
  const half = size.width / 2 / scales.x;
  const [low, high] = [view.time - half, view.time + half];
  context.fillStyle = ground;
  context.globalAlpha = 0.9;
  context.fillRect(0, size.height - AXIS, size.width, AXIS);
  context.globalAlpha = 1;
  context.fillStyle = quiet;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const most = Math.min(MAX_TICKS, Math.floor(size.width / 80));
  for (const time of ticksOf({ log: false, low, high }, most)) {
    const [x] = placeOf({ time, row: 0 }, scales, view, size);
    const outside = x < MARGIN.x / 2 || x > size.width - NAMED;
    if (!Number.isInteger(time) || time < 0 || outside) continue;
    context.fillRect(x - 0.5, size.height - AXIS, 1, 4);
    context.fillText(count(time), x, size.height - AXIS / 2 + 2);
  }
  context.textAlign = "right";
  context.fillText(text.generation, size.width - 12, size.height - AXIS / 2 + 2);
}

/** A ring around the focus, with its name and fitness beside it. */
function drawLabel(context: Context, { tree, size, theme, focus, landmarks }: Overlay, [x, y]: Place): void {
  const { ink, ground } = INKS[theme];
  if (!landmarks.some(({ creature }) => creature === focus)) {
    context.beginPath();
    context.arc(x, y, 6, 0, 2 * Math.PI);
    context.strokeStyle = ink;
    context.lineWidth = 2;
    context.stroke();
  }
  const fitness = tree.fitness[focus]!;
  const name = shortId(nameAt(tree, focus));
  const label = Number.isFinite(fitness) ? `${name} · ${number(fitness)}` : name;
  const width = context.measureText(label).width + 14;
  const left = x + 12 + width > size.width ? x - 12 - width : x + 12;
  context.beginPath();
  context.roundRect(left, y - 32, width, 22, 6);
  context.fillStyle = ink;
  context.fill();
  context.fillStyle = ground;
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.fillText(label, left + 7, y - 20.5);
}
