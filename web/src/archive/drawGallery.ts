/** Draw the visible part of a gallery at one moment. */

import type { Motion } from "../decode/replay";
import { type Size, type Theme, prepare } from "../ui/canvas";
import { css, sequential } from "../ui/colours";
import { type Colouring, colourPosition } from "./colouring";
import { type Shape, cornerOf } from "./layout";
import { FADED } from "./mapCanvas";
import { markDistrusted } from "./distrust";
import type { Tiles } from "./projection";
import { BODY_INK, traceBody } from "../replay/motion";

export interface GalleryPicture {
  shape: Shape;
  side: number;
  tiles: Tiles;
  /** The bins to draw. */
  bins: readonly number[];
  colouring: Colouring;
  motions: ReadonlyMap<string, Motion>;
  theme: Theme;
  marked: number | null;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
}

const INKS = {
  light: { body: BODY_INK.light, quiet: "rgb(18 34 44 / 0.3)", tint: 0.3 },
  dark: { body: BODY_INK.dark, quiet: "rgb(240 244 246 / 0.3)", tint: 0.38 },
};

/** `share` is the elapsed share of the replays; the window starts at `left` and `top` of the gallery. */
export function drawGallery(
  canvas: HTMLCanvasElement,
  size: Size,
  picture: GalleryPicture,
  [left, top]: readonly [number, number],
  share: number,
): void {
  const context = prepare(canvas, size);
  const { side, theme } = picture;
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = Math.max(1.25, side / 32);
  for (const bin of picture.bins) {
    const [x, y] = cornerOf(bin, picture.shape, side);
    drawTile(context, picture, bin, [x - left, y - top, side], share);
  }
  if (picture.marked === null) return;
  const [x, y] = cornerOf(picture.marked, picture.shape, side);
  context.strokeStyle = INKS[theme].body;
  context.lineWidth = 2;
  context.strokeRect(x - left + 1, y - top + 1, side - 2, side - 2);
}

function drawTile(
  context: CanvasRenderingContext2D,
  { tiles, colouring, motions, theme, selected }: GalleryPicture,
  bin: number,
  [left, top, side]: readonly [number, number, number],
  share: number,
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
  const motion = motions.get(tile.elite.creature);
  if (motion) {
    traceBody(context, motion, share, [left, top, side - 3]);
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
  context.globalAlpha = 1;
}
