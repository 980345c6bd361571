/** The cells of an archive on a canvas. */

import { type Size, prepare } from "../canvas";
import { css, viridis } from "../colours";
import { type Shape, rectangle } from "./geometry";
import type { Tiles } from "./projection";

export const FLASH_MS = 1200;
/** Cells narrower than this stand without a gap. */
const ROOMY = 5;

export type ColourBy = "fitness" | "generation";

export interface Picture {
  shape: Shape;
  tiles: Tiles;
  colourBy: ColourBy;
  range: [number, number];
  /** When elites last changed, by their cells in the archive, in milliseconds. */
  changed: ReadonlyMap<number, number>;
  /** A bin. */
  marked: number | null;
  ink: string;
  ground: string;
  empty: string;
}

export function rangeOf(tiles: Tiles, colourBy: ColourBy): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const { elite } of tiles.values()) {
    low = Math.min(low, elite[colourBy]);
    high = Math.max(high, elite[colourBy]);
  }
  return low <= high ? [low, high] : [0, 1];
}

export function drawCells(canvas: HTMLCanvasElement, size: Size, picture: Picture, now: number) {
  const context = prepare(canvas, size);
  const { shape, tiles, colourBy, range } = picture;
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
  for (const [bin, { elite }] of tiles) {
    context.fillStyle = css(viridis((elite[colourBy] - range[0]) / span));
    context.fillRect(...box(bin, gap));
  }
  drawFlashes(context, picture, box, now);
  if (picture.marked !== null) drawMark(context, box(picture.marked, 0), picture);
}

function drawFlashes(
  context: CanvasRenderingContext2D,
  { changed, tiles, ink }: Picture,
  box: (cell: number, inset: number) => readonly [number, number, number, number],
  now: number,
) {
  context.strokeStyle = ink;
  context.lineWidth = 2;
  for (const [bin, { cell }] of changed.size > 0 ? tiles : []) {
    const age = (now - (changed.get(cell) ?? -Infinity)) / FLASH_MS;
    if (age < 0 || age >= 1) continue;
    context.globalAlpha = (1 - age) ** 2;
    context.strokeRect(...box(bin, 1));
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
