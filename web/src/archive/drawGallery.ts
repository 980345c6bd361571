/** Draw the visible part of a gallery at one moment. */

import type { PoseStream } from "../decode/poses";
import { type Size, type Theme, prepare } from "../ui/canvas";
import { css, sequential } from "../ui/colours";
import { type Colouring, colourPosition } from "./colouring";
import { type Shape, cornerOf } from "./layout";
import { FADED } from "./mapCanvas";
import { markDistrusted } from "./distrust";
import type { Tiles } from "./projection";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";

export interface GalleryPicture {
  shape: Shape;
  side: number;
  tiles: Tiles;
  /** The bins to draw. */
  bins: readonly number[];
  colouring: Colouring;
  poses: ReadonlyMap<string, PoseStream>;
  theme: Theme;
  marked: number | null;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
  /** Creatures that people chose to breed. */
  chosen: ReadonlySet<string>;
}

const INKS = {
  light: { body: BODY_INK.light, quiet: "rgb(18 34 44 / 0.3)", tint: 0.3, chosen: "#b3263e" },
  dark: { body: BODY_INK.dark, quiet: "rgb(240 244 246 / 0.3)", tint: 0.38, chosen: "#ff8da0" },
};

/** `steps` are the simulated steps so far; the window starts at `left` and `top` of the gallery. */
export function drawGallery(
  canvas: HTMLCanvasElement,
  size: Size,
  picture: GalleryPicture,
  [left, top]: readonly [number, number],
  steps: number,
): void {
  const context = prepare(canvas, size);
  const { side, theme } = picture;
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = Math.max(1.25, side / 32);
  for (const bin of picture.bins) {
    const [x, y] = cornerOf(bin, picture.shape, side);
    drawTile(context, picture, bin, [x - left, y - top, side], steps);
  }
  if (picture.marked === null) return;
  const [x, y] = cornerOf(picture.marked, picture.shape, side);
  context.strokeStyle = INKS[theme].body;
  context.lineWidth = 2;
  context.strokeRect(x - left + 1, y - top + 1, side - 2, side - 2);
}

function drawTile(
  context: CanvasRenderingContext2D,
  { tiles, colouring, poses, theme, selected, chosen }: GalleryPicture,
  bin: number,
  [left, top, side]: readonly [number, number, number],
  steps: number,
): void {
  const { body, quiet, tint } = INKS[theme];
  const tile = tiles.get(bin)!;
  const position = colourPosition(colouring, tile);
  context.fillStyle = position === null ? quiet : css(sequential(position, colouring.palette));
  const strength = !selected || selected.has(bin) ? 1 : FADED;
  context.globalAlpha = tint * strength;
  context.fillRect(left + 1, top + 1, side - 2, side - 2);
  context.globalAlpha = strength;
  context.fillRect(left + 1, top + side - 4, side - 2, 3);
  const stream = poses.get(tile.elite.creature);
  if (stream) {
    traceBody(context, stream, steps, [left, top, side - 3]);
    context.strokeStyle = body;
  } else {
    context.beginPath();
    context.arc(left + side / 2, top + side / 2, 2, 0, 2 * Math.PI);
    context.strokeStyle = quiet;
  }
  context.stroke();
  if (tile.elite.trusted === false) {
    const { lineWidth } = context;
    markDistrusted(context, [left + side - 9, top + 9], 3, theme);
    context.lineWidth = lineWidth;
  }
  if (chosen.has(tile.elite.creature)) markChosen(context, [left + 5, top + 4], Math.max(8, side / 7), theme);
  context.globalAlpha = 1;
}

/** A filled heart with its top left corner at a place. */
function markChosen(
  context: CanvasRenderingContext2D,
  [left, top]: readonly [number, number],
  width: number,
  theme: Theme,
): void {
  const [middle, dip, low] = [left + width / 2, top + width * 0.28, top + width * 0.95];
  context.beginPath();
  context.moveTo(middle, low);
  context.bezierCurveTo(
    left - width * 0.35,
    top + width * 0.45,
    left + width * 0.1,
    top - width * 0.25,
    middle,
    dip,
  );
  context.bezierCurveTo(
    left + width * 0.9,
    top - width * 0.25,
    left + width * 1.35,
    top + width * 0.45,
    middle,
    low,
  );
  context.fillStyle = INKS[theme].chosen;
  context.fill();
}
