/** A GIF of the lanes: drawn step by step, as fast as the browser can, not recorded. */

import type { Size } from "../ui/canvas";
import { type Lane, drawRace, isOver } from "./race";

/** The widest GIF, in CSS pixels, and the colours of each frame. */
const [WIDEST, COLOURS] = [640, 96];
/** Frames at most, and milliseconds between them. */
const [MOST, DELAY_MS] = [150, 80];
/** Steps between frames at most: more would skip parts of a stroke. */
const FASTEST = 40;
/** Frames after which the page may respond. */
const TOGETHER = 4;

/**
 * `stepsPerSecond` are the simulated steps of a second of the film, unless it must be faster to reach the
 * end in time; `onProgress` gets frames done.
 */
export async function gifOf(
  lanes: Lane[],
  { width, height }: Size,
  stepsPerSecond: number,
  onProgress: (frames: number) => void,
): Promise<Blob> {
  const { GIFEncoder, applyPalette, quantize } = await import("gifenc");
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  const size = { width: Math.min(WIDEST, width), height };
  const film = GIFEncoder();
  const each = stepsOfFrame(lanes, size, (stepsPerSecond * DELAY_MS) / 1000);
  for (let frame = 0, steps = 0; frame < MOST && !isOver(lanes, steps, size); frame++) {
    drawRace(canvas, size, lanes, steps);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const palette = quantize(data, COLOURS);
    film.writeFrame(applyPalette(data, palette), canvas.width, canvas.height, { palette, delay: DELAY_MS });
    steps += each;
    if (frame % TOGETHER > 0) continue;
    onProgress(frame);
    await new Promise((resolve) => setTimeout(resolve));
  }
  film.finish();
  return new Blob([film.bytes()], { type: "image/gif" });
}

/** The steps between frames: the wanted ones, or as many more as bring the end into the film. */
function stepsOfFrame(lanes: Lane[], size: Size, wanted: number): number {
  for (let each = wanted; each < FASTEST; each += 4) {
    if (isOver(lanes, each * MOST, size)) return each;
  }
  return Math.max(wanted, FASTEST);
}
