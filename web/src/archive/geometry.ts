/** Positions of cells on the map. Cells count in C order, the last axis fastest. */

export type Shape = readonly [number, number];

/** The column (first axis, to the right) and the row (second axis, upwards) of a cell. */
export function columnAndRow(cell: number, shape: Shape) {
  return { i: Math.floor(cell / shape[1]), j: cell % shape[1] };
}

export function cellOf({ i, j }: { i: number; j: number }, shape: Shape): number {
  return i * shape[1] + j;
}

/** The cell at a point; x and y go from 0 to 1, y downwards as on a screen. */
export function cellAt(x: number, y: number, shape: Shape): number | null {
  if (x < 0 || x >= 1 || y < 0 || y >= 1) return null;
  const j = shape[1] - 1 - Math.floor(y * shape[1]);
  return cellOf({ i: Math.floor(x * shape[0]), j }, shape);
}

/** Left, top, width and height of a cell, in the units of `width` and `height`. */
export function rectangle(cell: number, shape: Shape, width: number, height: number) {
  const { i, j } = columnAndRow(cell, shape);
  const [w, h] = [width / shape[0], height / shape[1]];
  return { x: i * w, y: (shape[1] - 1 - j) * h, w, h };
}

/** Left and top of a tile in the gallery, in pixels. */
export function cornerOf(bin: number, shape: Shape, side: number): [left: number, top: number] {
  const { x, y } = rectangle(bin, shape, shape[0] * side, shape[1] * side);
  return [x, y];
}

interface Window {
  left: number;
  top: number;
  width: number;
  height: number;
}

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
