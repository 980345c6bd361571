/** Draw a filament over its target picture at a moment of the simulation. */

import type { Target } from "../../api/types";
import { type Size, prepare } from "../../ui/canvas";
import type { Replay } from "../../decode/replay";
import { type Point, positionsAt } from "../../replay/motion";

export interface Fold {
  replay: Replay;
  picture: OffscreenCanvas;
  target: Target;
  chains: number[][];
  /** Opacity of the picture, from 0 to 1. */
  shown: number;
  ink: { body: string; halo: string };
}

/** A picture in one colour on a transparent ground. */
export function pictureOf({ width, height, pixels }: Target, rgb: readonly number[]): OffscreenCanvas {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(width, height);
  const bytes = atob(pixels);
  for (let i = 0; i < width * height; i++) {
    image.data.set([...rgb, bytes.charCodeAt(i)], 4 * i);
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Place of a picture on the lattice: left, top (upwards), width and height, in cells. */
export function placeOf(target: Target, [width, height]: readonly [number, number]) {
  const scale = target.size / Math.max(target.width, target.height);
  const [wide, high] = [Math.round(scale * target.width), Math.round(scale * target.height)];
  const [left, bottom] = [Math.floor((width - wide) / 2), Math.floor((height - high) / 2)];
  // The centre of a cell is a whole coordinate.
  return { left: left - 0.5, top: bottom + high - 0.5, wide, high };
}

export function drawFold(canvas: HTMLCanvasElement, size: Size, fold: Fold, time: number): void {
  const context = prepare(canvas, size);
  const world = fold.replay.header.size;
  const scale = size.width / world[0];
  const screen = ([x, y]: Point): Point => [(x + 0.5) * scale, (world[1] - 0.5 - y) * scale];
  const { left, top, wide, high } = placeOf(fold.target, world);
  context.globalAlpha = fold.shown;
  context.imageSmoothingQuality = "high";
  context.drawImage(fold.picture, ...screen([left, top]), wide * scale, high * scale);
  context.globalAlpha = 1;
  const points = positionsAt(fold.replay, time).map(screen);
  context.lineCap = context.lineJoin = "round";
  for (const [colour, width] of [
    [fold.ink.halo, Math.max(2.6, 0.9 * scale)],
    [fold.ink.body, Math.max(1.1, 0.45 * scale)],
  ] as const) {
    context.beginPath();
    for (const chain of fold.chains) {
      chain.forEach((node, i) => context[i === 0 ? "moveTo" : "lineTo"](...points[node]!));
    }
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
}
