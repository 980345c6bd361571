/** Where a cell is on the map. Cells count in C order, the last axis fastest. */

import type { Axis } from "../api/types";

/** A cell's place: along the first axis (to the right) and the second (upwards). */
export interface Place {
  i: number;
  j: number;
}

export type Shape = readonly [number, number];

export function placeOf(cell: number, shape: Shape): Place {
  return { i: Math.floor(cell / shape[1]), j: cell % shape[1] };
}

export function cellOf({ i, j }: Place, shape: Shape): number {
  return i * shape[1] + j;
}

/** The cell under a point; x and y go from 0 to 1, y downwards as on a screen. */
export function cellAt(x: number, y: number, shape: Shape): number | null {
  if (x < 0 || x >= 1 || y < 0 || y >= 1) return null;
  const j = shape[1] - 1 - Math.floor(y * shape[1]);
  return cellOf({ i: Math.floor(x * shape[0]), j }, shape);
}

/** Left, top, width and height of a cell, in the same units as `width` and `height`. */
export function rectangle(cell: number, shape: Shape, width: number, height: number) {
  const { i, j } = placeOf(cell, shape);
  const [w, h] = [width / shape[0], height / shape[1]];
  return { x: i * w, y: (shape[1] - 1 - j) * h, w, h };
}

export interface Tick {
  /** From 0 at the low end to 1 at the high end. */
  at: number;
  value: number;
}

/** Round raw values along an axis, at most `most` of them. */
export function ticks(axis: Axis, most = 6): Tick[] {
  return axis.scale === "log10" ? decades(axis, most) : steps(axis, most);
}

function decades({ low, high }: Axis, most: number): Tick[] {
  const [from, to] = [Math.log10(low), Math.log10(high)];
  const every = Math.max(1, Math.ceil((to - from) / (most - 1)));
  const first = Math.ceil(from - 1e-9);
  const count = Math.floor((to + 1e-9 - first) / every) + 1;
  if (count < 2) return [low, high].map((value, at) => ({ at, value }));
  return Array.from({ length: count }, (_, k) => {
    const exponent = first + k * every;
    return { at: (exponent - from) / (to - from), value: 10 ** exponent };
  });
}

function steps({ low, high }: Axis, most: number): Tick[] {
  const step = roundStep((high - low) / (most - 1));
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, k) => {
    const value = Number(((first + k) * step).toPrecision(12));
    return { at: (value - low) / (high - low), value };
  });
}

/** The next 1, 2 or 5 times a power of ten. */
export function roundStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= least * (1 - 1e-9))!;
}
