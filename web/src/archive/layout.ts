/**
 * Layouts of the bins of a map; positions go from 0 to 1, to the right and downwards. Bins of a grid
 * count in C order, the last axis fastest.
 */

import type { Delaunay } from "d3-delaunay";

export type Shape = readonly [number, number];

/** The column (first axis, to the right) and the row (second axis, upwards) of a bin. */
export const columnAndRow = (bin: number, shape: Shape) => ({
  i: Math.floor(bin / shape[1]),
  j: bin % shape[1],
});

export const binFrom = ({ i, j }: { i: number; j: number }, shape: Shape) => i * shape[1] + j;

/** The bin at a point; x and y go from 0 to 1, y downwards as on a screen. */
export function binAt(x: number, y: number, shape: Shape): number | null {
  if (x < 0 || x >= 1 || y < 0 || y >= 1) return null;
  const j = shape[1] - 1 - Math.floor(y * shape[1]);
  return binFrom({ i: Math.floor(x * shape[0]), j }, shape);
}

/** Left, top, width and height of a bin, in the units of `width` and `height`. */
export function rectangle(bin: number, shape: Shape, width: number, height: number) {
  const { i, j } = columnAndRow(bin, shape);
  const [w, h] = [width / shape[0], height / shape[1]];
  return { x: i * w, y: (shape[1] - 1 - j) * h, w, h };
}

/** Left and top of a tile in the gallery, in pixels. */
export function cornerOf(bin: number, shape: Shape, side: number): [left: number, top: number] {
  const { x, y } = rectangle(bin, shape, shape[0] * side, shape[1] * side);
  return [x, y];
}

type Window = Record<"left" | "top" | "width" | "height", number>;

/** The filled bins that a window of the gallery shows, sorted from its middle. */
export function visibleBins(
  filled: Iterable<number>,
  shape: Shape,
  side: number,
  { left, top, width, height }: Window,
): number[] {
  const middle = [left + width / 2 - side / 2, top + height / 2 - side / 2] as const;
  const found: [bin: number, distance: number][] = [];
  for (const bin of filled) {
    const [x, y] = cornerOf(bin, shape, side);
    if (x + side <= left || x >= left + width || y + side <= top || y >= top + height) continue;
    found.push([bin, Math.hypot(x - middle[0], y - middle[1])]);
  }
  return found.sort((a, b) => a[1] - b[1]).map(([bin]) => bin);
}

export type Position = readonly [x: number, y: number];

export interface Layout {
  readonly count: number;
  /** The bin at a position; null outside the map. */
  at(x: number, y: number): number | null;
  centre(bin: number): Position;
  outline(bin: number): Position[];
}

export function gridLayout(shape: Shape): Layout {
  return {
    count: shape[0] * shape[1],
    at: (x, y) => binAt(x, y, shape),
    centre: (bin) => {
      const { x, y, w, h } = rectangle(bin, shape, 1, 1);
      return [x + w / 2, y + h / 2];
    },
    outline: (bin) => {
      const { x, y, w, h } = rectangle(bin, shape, 1, 1);
      return [
        [x, y],
        [x + w, y],
        [x + w, y + h],
        [x, y + h],
      ];
    },
  };
}

/** The Voronoi cells of a CVT as bins of the map. */
export function voronoiLayout(points: Position[], tessellate: typeof Delaunay): Layout {
  const delaunay = tessellate.from(
    points,
    ([x]) => x,
    ([, y]) => y,
  );
  const cells = delaunay.voronoi([0, 0, 1, 1]);
  let last = 0; // The search starts here: the next position is mostly nearby.
  return {
    count: points.length,
    at: (x, y) => {
      if (x < 0 || x >= 1 || y < 0 || y >= 1) return null;
      return (last = delaunay.find(x, y, last));
    },
    centre: (bin) => points[bin]!,
    outline: (bin) => (cells.cellPolygon(bin) ?? []).slice(0, -1) as unknown as Position[],
  };
}

export type Direction = "ArrowLeft" | "ArrowRight" | "ArrowUp" | "ArrowDown";

const STEPS: Record<Direction, Position> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

export const isDirection = (key: string): key is Direction => key in STEPS;

/** The nearest filled bin in a direction; the distance across it counts twice. */
export function nextBin(
  from: number,
  direction: Direction,
  filled: Iterable<number>,
  layout: Layout,
): number | null {
  const [dx, dy] = STEPS[direction];
  const start = layout.centre(from);
  let best: number | null = null;
  let least = Infinity;
  for (const bin of filled) {
    const [x, y] = layout.centre(bin);
    const ahead = (x - start[0]) * dx + (y - start[1]) * dy;
    const aside = Math.abs((x - start[0]) * dy) + Math.abs((y - start[1]) * dx);
    const cost = ahead + 2 * aside;
    if (ahead > 1e-9 && cost < least) [best, least] = [bin, cost];
  }
  return best;
}

/** Narrower bins, in CSS pixels, have no gap. */
const MIN_WIDTH = 5;

/** The bin at each pixel of a picture; −1 in the gaps between bins. */
export function rasterOf(layout: Layout, width: number, height: number, density: number) {
  const raster = new Int32Array(width * height);
  for (let row = 0, k = 0; row < height; row++) {
    const y = (row + 0.5) / height;
    for (let column = 0; column < width; column++, k++) {
      raster[k] = layout.at((column + 0.5) / width, y) ?? -1;
    }
  }
  const side = Math.sqrt((width * height) / layout.count) / density;
  if (side >= MIN_WIDTH) cutGaps(raster, width, Math.max(1, Math.round(density)));
  return raster;
}

/** Go backwards, so that the compared neighbours are still unchanged. */
function cutGaps(raster: Int32Array, width: number, gap: number): void {
  for (let k = raster.length - 1; k >= 0; k--) {
    const column = k % width;
    const left = column >= gap ? raster[k - gap] : raster[k];
    const above = k >= gap * width ? raster[k - gap * width] : raster[k];
    if (left !== raster[k] || above !== raster[k]) raster[k] = -1;
  }
}
