/** Draw the cells of an archive on a canvas, and flashes above them. */

import { type Size, type Theme, prepare } from "../ui/canvas";
import { type Rgb, pixel } from "../ui/colours";
import { type Colouring, binColours } from "./colouring";
import { type Layout, rasterOf } from "./layout";
import type { Tiles } from "./projection";

export const FLASH_MS = 1200;
/** Opacity of cells that are not selected. */
export const FADED = 0.28;

export interface Picture {
  layout: Layout;
  tiles: Tiles;
  colouring: Colouring;
  /** Times of the last changes by cell, in milliseconds. */
  changed: ReadonlyMap<number, number>;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
  theme: Theme;
}

const inks = (flash: string, ground: Rgb) => ({
  flash,
  empty: pixel(ground, 0.055),
  unknown: pixel(ground, 0.25),
});
const INKS = { light: inks("#0b1216", [20, 50, 70]), dark: inks("#f4f8fa", [180, 215, 235]) };

/** Draws maps on one canvas; caches the raster of its size and layout. */
export class MapPainter {
  private layout: Layout | null = null;
  private raster = new Int32Array(0);
  private image: ImageData | null = null;

  draw(canvas: HTMLCanvasElement, size: Size, picture: Picture, now: number): void {
    performance.clearMeasures("map-draw");
    const begun = performance.now();
    const context = prepare(canvas, size);
    const image = this.fit(canvas, size, picture.layout);
    const { layout, tiles, colouring } = picture;
    const { empty, unknown, flash } = INKS[picture.theme];
    const colours = binColours(tiles, layout.count, colouring, empty, unknown);
    if (picture.selected) fade(colours, tiles, picture.selected);
    paint(image, this.raster, colours);
    context.putImageData(image, 0, 0);
    drawFlashes(context, size, picture, flash, now);
    performance.measure("map-draw", { start: begun });
  }

  private fit({ width, height }: HTMLCanvasElement, size: Size, layout: Layout): ImageData {
    const fits = this.image?.width === width && this.image.height === height;
    if (this.image && fits && this.layout === layout) return this.image;
    this.layout = layout;
    this.raster = rasterOf(layout, width, height, width / size.width);
    return (this.image = new ImageData(width, height));
  }
}

/** Fade all bins that are not selected. */
function fade(colours: Uint32Array, tiles: Tiles, selected: ReadonlySet<number>): void {
  for (const bin of tiles.keys()) {
    if (selected.has(bin)) continue;
    const bytes = new Uint8Array(colours.buffer, 4 * bin, 4);
    bytes[3] = bytes[3]! * FADED;
  }
}

function paint(image: ImageData, raster: Int32Array, colours: Uint32Array): void {
  const pixels = new Uint32Array(image.data.buffer);
  for (let k = 0; k < raster.length; k++) {
    const bin = raster[k]!;
    pixels[k] = bin < 0 ? 0 : colours[bin]!;
  }
}

function drawFlashes(
  context: CanvasRenderingContext2D,
  { width, height }: Size,
  { changed, tiles, layout }: Picture,
  ink: string,
  now: number,
) {
  context.strokeStyle = ink;
  context.lineWidth = 2;
  for (const [bin, { cell }] of changed.size > 0 ? tiles : []) {
    const age = (now - (changed.get(cell) ?? -Infinity)) / FLASH_MS;
    if (age < 0 || age >= 1) continue;
    context.globalAlpha = (1 - age) ** 2;
    context.beginPath();
    for (const [x, y] of layout.outline(bin)) context.lineTo(x * width, y * height);
    context.closePath();
    context.stroke();
  }
  context.globalAlpha = 1;
}
