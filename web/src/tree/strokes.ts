/**
 * Lines and dots, in pixels, of the part of a tree that a view shows. A subtree of less than a pixel is one line, and
 * lines that cover each other are drawn once: the work grows with the window, not with the tree.
 */

import { type Phylogeny, NONE } from "../decode/phylogeny";
import type { Size } from "../ui/canvas";
import type { Chains, TreeLayout } from "./layout";
import { type Scales, type View } from "./view";

export interface Scene {
  tree: Phylogeny;
  layout: TreeLayout;
  chains: Chains;
  view: View;
  scales: Scales;
  size: Size;
  /** The time shown; what is later is not drawn. */
  at: number;
  /** True if creatures within lines of single descendants are drawn. */
  whole: boolean;
  /** The colour of each creature, as an index. */
  shade: Uint8Array;
  shades: number;
}

/** Widths of edges in pixels, by the number of descendants. */
export const WIDTHS = [0.8, 1.1, 1.7, 2.6, 4];
const SIZES = [2, 8, 64, 512];
/** Height of a subtree, in pixels, below which it is one line; of a row, above which it has dots. */
const [LUMP, DOTS] = [0.75, 5];
/** Rows that have room for a count, and its length, in pixels. */
const [COUNTED, COUNT_LENGTH] = [15, 64];
/** Pixels within which an edge leaves the row of its parent. */
const BEND = 34;

export interface Strokes {
  /** Lines by width and shade, four numbers each: x and y of the start, then of the end. */
  lines: number[][];
  /** Three numbers each: x, y, and the creature. */
  dots: number[];
  /** Three numbers each: x, y, and the number of creatures that an edge stands for. */
  counts: number[];
}

export const lineIndex = (width: number, shade: number, shades: number) => width * shades + shade;

export function strokesOf(scene: Scene): Strokes {
  const { tree, layout, view, scales, size, at, shade, shades } = scene;
  const { order, end, low, rows, last, row, parent, size: descendants } = layout;
  const found: Strokes = {
    lines: Array.from({ length: WIDTHS.length * shades }, () => []),
    dots: [],
    counts: [],
  };
  const xOf = (time: number) => size.width / 2 + (time - view.time) * scales.x;
  const yOf = (at: number) => size.height / 2 + (at - view.row) * scales.y;
  const firstTime = view.time - size.width / 2 / scales.x;
  const lastTime = Math.min(at, view.time + size.width / 2 / scales.x);
  const beside = new Map<number, number>();
  const lump = { y: NaN, from: 0, to: 0 };
  for (let p = 0; p < order.length;) {
    const i = order[p]!;
    const above = parent[i]!;
    const since = above === NONE ? tree.time[i]! : tree.time[above]!;
    const [top, bottom] = [yOf(low[i]! - 0.5), yOf(low[i]! + rows[i]! - 0.5)];
    const outside = bottom < 0 ? 1 : top > size.height ? 2 : 0;
    const line = found.lines[lineIndex(widthOf(descendants[i]!), shade[i]!, shades)]!;
    if (since > lastTime || last[i]! < firstTime || tree.time[i]! > at) p = end[p]!;
    else if (outside) {
      // One edge of a parent on this side covers all others.
      if (above !== NONE && crosses(outside, yOf(row[above]!), size) && !seen(beside, above, outside))
        line.push(xOf(since), yOf(row[above]!), xOf(tree.time[i]!), yOf(row[i]!));
      p = end[p]!;
    } else if (bottom - top < LUMP) {
      drawLump(scene, found.lines, i, [xOf(since), xOf(Math.min(at, last[i]!))], yOf, lump);
      p = end[p]!;
    } else {
      drawCreature(scene, found, line, i, xOf, yOf);
      p++;
    }
  }
  return found;
}

function widthOf(size: number): number {
  let width = 0;
  while (width < SIZES.length && size >= SIZES[width]!) width++;
  return width;
}

const crosses = (outside: number, y: number, { height }: Size) => (outside === 1 ? y >= 0 : y <= height);

function seen(beside: Map<number, number>, above: number, side: number): boolean {
  const known = beside.get(above) ?? 0;
  beside.set(above, known | side);
  return (known & side) !== 0;
}

function drawLump(
  { layout: { row, parent, low, rows, size }, shade, shades }: Scene,
  lines: number[][],
  i: number,
  [from, to]: [number, number],
  yOf: (row: number) => number,
  lump: { y: number; from: number; to: number },
): void {
  const y = yOf(low[i]! + (rows[i]! - 1) / 2);
  const pixel = Math.round(y);
  const covered = pixel === lump.y && from >= lump.from && to <= lump.to;
  if (covered) return;
  const same = pixel === lump.y;
  lump.from = same ? Math.min(lump.from, from) : from;
  lump.to = same ? Math.max(lump.to, to) : to;
  lump.y = pixel;
  const start = parent[i] === NONE ? y : yOf(row[parent[i]!]!);
  lines[lineIndex(Math.min(1, widthOf(size[i]!)), shade[i]!, shades)]!.push(from, start, to, y);
}

/** The edge to a creature with its dot, or with the number of creatures that it stands for. */
function drawCreature(
  { tree, layout, chains, scales, whole }: Scene,
  found: Strokes,
  line: number[],
  i: number,
  xOf: (time: number) => number,
  yOf: (row: number) => number,
): void {
  const [x, y] = [xOf(tree.time[i]!), yOf(layout.row[i]!)];
  const above = layout.parent[i]!;
  if (above !== NONE) line.push(xOf(tree.time[above]!), yOf(layout.row[above]!), x, y);
  if (scales.y < DOTS || (!whole && chains.within[i])) return;
  found.dots.push(x, y, i);
  const between = chains.between[i]!;
  if (whole || between === 0 || scales.y < COUNTED) return;
  const from = xOf(tree.time[chains.above[i]!]!);
  if (x - from > COUNT_LENGTH) found.counts.push((from + x) / 2, y, between);
}

/** The control points of an edge: it bends at its start, where siblings of the child do so too. */
export function bendOf(x: number, y: number, toX: number, toY: number) {
  const bend = Math.min(BEND, toX - x, Math.abs(toY - y));
  return { straightFrom: x + bend, middle: x + bend / 2 };
}
