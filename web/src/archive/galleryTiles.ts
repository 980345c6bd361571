/** Where the tiles of a wall are, in pixels: bins of the map, each as large as one wants it. */

import type { Shape } from "./geometry";
import { placeOf } from "./geometry";

export interface Window {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Left and top of a bin's tile. */
export function cornerOf(bin: number, shape: Shape, side: number): [left: number, top: number] {
  const { i, j } = placeOf(bin, shape);
  return [i * side, (shape[1] - 1 - j) * side];
}

/** The filled bins that a window shows, from its middle outwards. */
export function visibleBins(
  filled: Iterable<number>,
  shape: Shape,
  side: number,
  { left, top, width, height }: Window,
): number[] {
  const middle = [left + width / 2 - side / 2, top + height / 2 - side / 2] as const;
  const found: [bin: number, away: number][] = [];
  for (const bin of filled) {
    const [x, y] = cornerOf(bin, shape, side);
    if (x + side <= left || x >= left + width || y + side <= top || y >= top + height) continue;
    found.push([bin, Math.hypot(x - middle[0], y - middle[1])]);
  }
  return found.sort((a, b) => a[1] - b[1]).map(([bin]) => bin);
}
