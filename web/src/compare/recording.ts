/** Save what a canvas shows: one picture, or a film of it. */

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
  canvas.toBlob((blob) => blob && save(blob, `${name}.png`));
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
  if (!signal.aborted) save(new Blob(parts, { type }), `${name}.${ending}`);
}

export function save(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), LONGEST_MS);
}
