/** The visible part of a tree: one zoom level for both axes, and a centre. */

import { type Phylogeny, NONE } from "../decode/phylogeny";
import type { Size } from "../ui/canvas";
import type { TreeLayout } from "./layout";

export interface View {
  /** From 0, the whole tree, to 1, single creatures. */
  zoom: number;
  /** The time and the row in the middle. */
  time: number;
  row: number;
}

/** Pixels for a generation and for a row. */
export interface Scales {
  x: number;
  y: number;
}

/** The size of a tree, on which its scales depend. */
export interface Extent {
  firstTime: number;
  lastTime: number;
  rows: number;
  /** The gap in time between a parent and a child that most of them have at least. */
  gap: number;
}

/** Pixels around the whole tree: room for a body at each end. */
export const MARGIN = { x: 44, top: 26, bottom: 40 };
/** Pixels of a row, and of a gap between parent and child, at the highest zoom. */
const CLOSE = { row: 64, gap: 110 };
const GAP_SHARE = 0.25;
/** Natural logarithm of the enlargement from the whole to the highest zoom, at least. */
const LEAST_RANGE = 0.7;

export function extentOf({ time, count }: Phylogeny, { parent, row, totalRows }: TreeLayout): Extent {
  let [firstTime, lastTime] = [Infinity, -Infinity];
  const gaps: number[] = [];
  for (let i = 0; i < count; i++) {
    if (row[i] === NONE) continue;
    firstTime = Math.min(firstTime, time[i]!);
    lastTime = Math.max(lastTime, time[i]!);
    if (parent[i] !== NONE) gaps.push(time[i]! - time[parent[i]!]!);
  }
  if (totalRows === 0) return { firstTime: 0, lastTime: 0, rows: 0, gap: 1 }; // Nothing is shown.
  const gap = Int32Array.from(gaps).sort()[Math.floor(GAP_SHARE * gaps.length)] ?? 1;
  return { firstTime, lastTime, rows: totalRows, gap };
}

/** Both scales reach their highest value at the same zoom level. */
export function scalesOf(extent: Extent, size: Size, zoom: number): Scales {
  const [close, fit] = [closest(extent), fitting(extent, size)];
  const between = (low: number, high: number) => low ** (1 - zoom) * high ** zoom;
  return { x: between(Math.min(fit.x, close.x), close.x), y: between(Math.min(fit.y, close.y), close.y) };
}

const closest = ({ gap }: Extent): Scales => ({ x: CLOSE.gap / gap, y: CLOSE.row });

function fitting({ firstTime, lastTime, rows }: Extent, { width, height }: Size): Scales {
  return {
    x: Math.max(1, width - 2 * MARGIN.x) / Math.max(1, lastTime - firstTime),
    y: Math.max(1, height - MARGIN.top - MARGIN.bottom) / Math.max(1, rows),
  };
}

/** The view of everything. */
export const whole = ({ firstTime, lastTime, rows }: Extent): View => ({
  zoom: 0,
  time: (firstTime + lastTime) / 2,
  row: (rows - 1) / 2,
});

/** The nearest view in which the tree fills the window as far as it can. */
export function clamped(view: View, extent: Extent, size: Size): View {
  const zoom = Math.min(1, Math.max(0, view.zoom));
  const { x, y } = scalesOf(extent, size, zoom);
  const [top, bottom] = [-0.5 - MARGIN.top / y, extent.rows - 0.5 + MARGIN.bottom / y];
  return {
    zoom,
    time: within(
      view.time,
      extent.firstTime - MARGIN.x / x,
      extent.lastTime + MARGIN.x / x,
      size.width / x / 2,
    ),
    row: within(view.row, top, bottom, size.height / y / 2),
  };
}

/** The centre of a window of half a length that stays between two ends, or their middle. */
function within(centre: number, low: number, high: number, half: number): number {
  if (high - low <= 2 * half) return (low + high) / 2;
  return Math.min(high - half, Math.max(low + half, centre));
}

/** A point of the window, from its upper left corner. */
export type Place = readonly [x: number, y: number];

export function placeOf(
  { time, row }: Pick<View, "time" | "row">,
  { x, y }: Scales,
  view: View,
  size: Size,
): Place {
  return [size.width / 2 + (time - view.time) * x, size.height / 2 + (row - view.row) * y];
}

/** The change of the zoom level that enlarges rows by a factor, given as its natural logarithm. */
export function zoomFor(log: number, extent: Extent, size: Size): number {
  const { x, y } = fitting(extent, size);
  const close = closest(extent);
  return log / Math.max(LEAST_RANGE, Math.log(close.y / y), Math.log(close.x / x));
}

/** The zoom level at which a row has a height, or the nearest to it. */
export function zoomOf(height: number, extent: Extent, size: Size): number {
  const [low, high] = [Math.min(fitting(extent, size).y, CLOSE.row), CLOSE.row];
  return low >= height ? 0 : Math.log(height / low) / Math.log(high / low);
}

/** The view after a change of zoom that keeps what is at a place there. */
export function zoomed(view: View, change: number, [x, y]: Place, extent: Extent, size: Size): View {
  const before = scalesOf(extent, size, view.zoom);
  const zoom = Math.min(1, Math.max(0, view.zoom + change));
  const after = scalesOf(extent, size, zoom);
  const moved = {
    zoom,
    time: view.time + (x - size.width / 2) * (1 / before.x - 1 / after.x),
    row: view.row + (y - size.height / 2) * (1 / before.y - 1 / after.y),
  };
  return clamped(moved, extent, size);
}

export function moved(view: View, [x, y]: Place, extent: Extent, size: Size): View {
  const scales = scalesOf(extent, size, view.zoom);
  return clamped({ ...view, time: view.time - x / scales.x, row: view.row - y / scales.y }, extent, size);
}
