/** Paint a field of the fluid around a camera; the world repeats in both directions. */

import type { Replay } from "../decode/replay";
import { type Field, coloursOf } from "./fields";
import { type Point, wrap } from "./motion";

/** Cells drawn beyond the view, so that smoothing does not reach the image's edge. */
const MARGIN = 2;

export class FluidPainter {
  private readonly image: ImageData;
  private readonly canvas: OffscreenCanvas;
  private readonly colours: Uint32Array;

  constructor(
    private readonly replay: Replay,
    private readonly field: Field,
  ) {
    const [width, height] = replay.header.size;
    this.canvas = new OffscreenCanvas(width + 2 * MARGIN, height + 2 * MARGIN);
    this.image = new ImageData(this.canvas.width, this.canvas.height);
    this.colours = coloursOf(field, replay);
  }

  /** Fill a context of `scale` pixels per cell with the flow at `time` around `camera`. */
  paint(context: CanvasRenderingContext2D, time: number, camera: Point, scale: number): void {
    const [width, height] = this.replay.header.size;
    const left = camera[0] - width / 2;
    const bottom = camera[1] - height / 2;
    const [x0, y0] = [Math.floor(left) - 1, Math.floor(bottom) - 1];
    this.fill(time, x0, y0);
    this.canvas.getContext("2d")!.putImageData(this.image, 0, 0);
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    const top = bottom + height - (y0 + this.canvas.height - 0.5);
    context.drawImage(
      this.canvas,
      (x0 - 0.5 - left) * scale,
      top * scale,
      this.canvas.width * scale,
      this.canvas.height * scale,
    );
  }

  private fill(time: number, x0: number, y0: number): void {
    const { size, frames } = this.replay.header;
    const [width, height] = size;
    const before = Math.min(frames - 1, Math.floor(time));
    const after = Math.min(frames - 1, before + 1);
    const t = time - before;
    const { zero } = this.field;
    const [old, next] = [before, after].map((frame) => this.field.plane(this.replay, frame));
    const pixels = new Uint32Array(this.image.data.buffer);
    const { width: columns, height: rows } = this.canvas;
    for (let column = 0; column < columns; column++) {
      const x = wrap(x0 + column, width);
      const first = x * height;
      for (let row = 0; row < rows; row++) {
        const y = wrap(y0 + rows - 1 - row, height);
        const value = (1 - t) * old![first + y]! + t * next![first + y]!;
        pixels[row * columns + column] = this.colours[Math.round(value) + zero]!;
      }
    }
  }
}
