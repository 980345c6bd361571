/** The canvas of a map: the cells of an archive, marks of distrusted elites, and flashes of changed cells. */

import { useEffect, useMemo, useRef } from "preact/hooks";
import type { Elites } from "../store/elites";
import { type Size, type Theme, prepare, prefersReducedMotion, useTheme } from "../ui/canvas";
import { type Rgb, pixel } from "../ui/colours";
import { type Colouring, binColours } from "./colouring";
import { type Layout, rasterOf } from "./layout";
import type { Tiles } from "./projection";

const FLASH_MS = 1200;
/** Side of the smallest bins that are marked, in pixels. */
const MIN_MARKED = 8;
/** Opacity of cells that are not selected. */
export const FADED = 0.28;

interface MapContent {
  layout: Layout;
  tiles: Tiles;
  colouring: Colouring;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
}

interface Picture extends MapContent {
  /** Times of the last changes by cell, in milliseconds. */
  changed: ReadonlyMap<number, number>;
  theme: Theme;
}

const inks = (flash: string, ground: Rgb) => ({
  flash,
  empty: pixel(ground, 0.055),
  unknown: pixel(ground, 0.25),
});
const INKS = { light: inks("#0b1216", [20, 50, 70]), dark: inks("#f4f8fa", [180, 215, 235]) };

/** Draw the map when it changes, and flash changed cells. */
export function useMapCanvas(size: Size, content: MapContent, elites: Elites) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const changed = useChanges(elites);
  const raster = useMemo(() => new Raster(content.layout), [content.layout]);
  useEffect(() => {
    const element = canvas.current;
    if (!element || size.width === 0) return;
    const picture = { ...content, theme, changed };
    const stop = animate((now) => {
      drawMap(element, size, raster, picture, now);
      return [...changed.values()].some((time) => now - time < FLASH_MS);
    });
    performance.clearMarks("map");
    performance.mark("map");
    return stop;
  }, [size, theme, changed, ...Object.values(content)]);
  return canvas;
}

/** The time of the last change of each cell; the first elites do not count. */
function useChanges(elites: Elites): ReadonlyMap<number, number> {
  const seen = useRef<Elites | null>(null);
  const times = useRef<ReadonlyMap<number, number>>(new Map());
  if (seen.current !== elites) {
    const before = seen.current;
    const now = performance.now();
    const next = new Map([...times.current].filter(([, time]) => now - time < FLASH_MS));
    for (const [cell, elite] of before && !prefersReducedMotion() ? elites : []) {
      if (before!.get(cell)?.creature !== elite.creature) next.set(cell, now);
    }
    seen.current = elites;
    times.current = next;
  }
  return times.current;
}

/** Draw at once, and in every frame while `draw` returns true. */
function animate(draw: (now: number) => boolean): () => void {
  let frame = 0;
  const step = () => {
    if (draw(performance.now())) frame = requestAnimationFrame(step);
  };
  step();
  return () => cancelAnimationFrame(frame);
}

/** The bin of each pixel, and the image that shows them; both are cached for the size of a canvas. */
class Raster {
  bins = new Int32Array(0);
  image: ImageData | null = null;

  constructor(private readonly layout: Layout) {}

  fit({ width, height }: HTMLCanvasElement, size: Size): ImageData {
    if (this.image?.width === width && this.image.height === height) return this.image;
    this.bins = rasterOf(this.layout, width, height, width / size.width);
    return (this.image = new ImageData(width, height));
  }
}

function drawMap(canvas: HTMLCanvasElement, size: Size, raster: Raster, picture: Picture, now: number): void {
  performance.clearMeasures("map-draw");
  const start = performance.now();
  const context = prepare(canvas, size);
  const image = raster.fit(canvas, size);
  const { layout, tiles, colouring, selected } = picture;
  const { empty, unknown, flash } = INKS[picture.theme];
  const colours = binColours(tiles, layout.count, colouring, empty, unknown);
  if (selected) fade(colours, tiles, selected);
  paint(image, raster.bins, colours);
  context.putImageData(image, 0, 0);
  drawDistrusted(context, size, picture);
  drawFlashes(context, size, picture, flash, now);
  performance.measure("map-draw", { start });
}

/** Fade all bins that are not selected. */
function fade(colours: Uint32Array, tiles: Tiles, selected: ReadonlySet<number>): void {
  for (const bin of tiles.keys()) {
    if (selected.has(bin)) continue;
    const bytes = new Uint8Array(colours.buffer, 4 * bin, 4);
    bytes[3] = bytes[3]! * FADED;
  }
}

function paint(image: ImageData, bins: Int32Array, colours: Uint32Array): void {
  const pixels = new Uint32Array(image.data.buffer);
  for (let k = 0; k < bins.length; k++) pixels[k] = bins[k]! < 0 ? 0 : colours[bins[k]!]!;
}

/** Mark elites that are not trusted, unless bins are too small for a mark. */
function drawDistrusted(
  context: CanvasRenderingContext2D,
  { width, height }: Size,
  { tiles, layout }: Picture,
): void {
  const side = Math.sqrt((width * height) / layout.count);
  if (side < MIN_MARKED) return;
  for (const [bin, { elite }] of tiles) {
    if (elite.trusted !== false) continue;
    const [x, y] = layout.centre(bin);
    markDistrusted(context, [x * width, y * height], Math.min(3.5, side / 6), "dark");
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

const CROSS_INKS = { light: ["#ffffff", "#12222c"], dark: ["#111b21", "#fdf8ec"] } as const;

/** Draw a small cross on a light or dark ground, with a border; lengths in pixels. */
export function markDistrusted(
  context: CanvasRenderingContext2D,
  [x, y]: readonly [number, number],
  radius: number,
  ground: Theme,
): void {
  const [border, ink] = CROSS_INKS[ground];
  context.beginPath();
  for (const slope of [1, -1]) {
    context.moveTo(x - radius, y - slope * radius);
    context.lineTo(x + radius, y + slope * radius);
  }
  for (const [style, width] of [
    [border, 3.5],
    [ink, 1.5],
  ] as const) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }
}
