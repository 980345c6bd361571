/** The cells of an archive on a canvas. */

import type { Elites } from "../../live/elites";
import { type Size, prepare } from "../canvas";
import { css, viridis } from "../colours";
import { type Shape, rectangle } from "./geometry";

export const FLASH_MS = 1200;
/** Cells narrower than this stand without a gap. */
const ROOMY = 5;

export type ColourBy = "fitness" | "generation";

export interface Picture {
  shape: Shape;
  elites: Elites;
  colourBy: ColourBy;
  range: [number, number];
  /** When cells last changed, in milliseconds. */
  changed: ReadonlyMap<number, number>;
  marked: number | null;
  ink: string;
  ground: string;
  empty: string;
}

export function rangeOf(elites: Elites, colourBy: ColourBy): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const elite of elites.values()) {
    low = Math.min(low, elite[colourBy]);
    high = Math.max(high, elite[colourBy]);
  }
  return low <= high ? [low, high] : [0, 1];
}

export function drawCells(canvas: HTMLCanvasElement, size: Size, picture: Picture, now: number) {
  const context = prepare(canvas, size);
  const { shape, elites, colourBy, range } = picture;
  const gap = Math.min(size.width / shape[0], size.height / shape[1]) >= ROOMY ? 0.5 : 0;
  const box = (cell: number, inset: number) => {
    const { x, y, w, h } = rectangle(cell, shape, size.width, size.height);
    return [x + inset, y + inset, w - 2 * inset, h - 2 * inset] as const;
  };
  if (gap > 0) {
    context.fillStyle = picture.empty;
    for (let cell = 0; cell < shape[0] * shape[1]; cell++) context.fillRect(...box(cell, gap));
  }
  const span = range[1] - range[0] || 1;
  for (const [cell, elite] of elites) {
    context.fillStyle = css(viridis((elite[colourBy] - range[0]) / span));
    context.fillRect(...box(cell, gap));
  }
  drawFlashes(context, picture, box, now);
  if (picture.marked !== null) drawMark(context, box(picture.marked, 0), picture);
}

function drawFlashes(
  context: CanvasRenderingContext2D,
  { changed, ink }: Picture,
  box: (cell: number, inset: number) => readonly [number, number, number, number],
  now: number,
) {
  context.strokeStyle = ink;
  context.lineWidth = 2;
  for (const [cell, time] of changed) {
    const age = (now - time) / FLASH_MS;
    if (age < 0 || age >= 1) continue;
    context.globalAlpha = (1 - age) ** 2;
    context.strokeRect(...box(cell, 1));
  }
  context.globalAlpha = 1;
}

function drawMark(
  context: CanvasRenderingContext2D,
  [x, y, w, h]: readonly [number, number, number, number],
  { ink, ground }: Picture,
) {
  for (const [colour, width] of [[ground, 5], [ink, 2]] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.strokeRect(x - 1, y - 1, w + 2, h + 2);
  }
}
