/** Save what a race shows: one picture, a film of the canvas, or a GIF that is drawn frame by frame. */

import { saveFile } from "../api/files";
import type { Size } from "../ui/canvas";
import { type Lane, drawRace, isOver } from "./race";

const KINDS = [
  ["video/mp4;codecs=avc1", "mp4"],
  ["video/webm;codecs=vp9", "webm"],
  ["video/webm", "webm"],
] as const;
const FRAMES_PER_SECOND = 30;
const BITS_PER_SECOND = 6_000_000;
const LONGEST_MS = 30_000;
const LOOK_MS = 100;

const kind = () =>
  typeof MediaRecorder === "undefined"
    ? undefined
    : KINDS.find(([type]) => MediaRecorder.isTypeSupported(type));

export const canFilm = () => kind() !== undefined;

export function savePicture(canvas: HTMLCanvasElement, name: string): void {
  canvas.toBlob((blob) => blob && saveFile(blob, `${name}.png`));
}

/** Record a canvas until `isOver`, half a minute at most, and save the film unless it is aborted. */
export async function film(
  canvas: HTMLCanvasElement,
  name: string,
  isOver: () => boolean,
  signal: AbortSignal,
): Promise<void> {
  const [type, ending] = kind()!;
  const stream = canvas.captureStream(FRAMES_PER_SECOND);
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: BITS_PER_SECOND });
  const parts: Blob[] = [];
  recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
  const stopped = new Promise((resolve) => recorder.addEventListener("stop", resolve));
  recorder.start();
  const begun = performance.now();
  while (!signal.aborted && !isOver() && performance.now() - begun < LONGEST_MS)
    await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
  recorder.stop();
  await stopped;
  for (const track of stream.getTracks()) track.stop();
  if (!signal.aborted) saveFile(new Blob(parts, { type }), `${name}.${ending}`);
}

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
