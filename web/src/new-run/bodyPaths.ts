/** Lines and dots of the drawing of a body, in cells. */

import type { DrawnBody } from "../api/types";

export const GRID = 8;

const at = ([x, y]: number[]) => `${x} ${y}`;

export function linesOf({ positions, edges }: DrawnBody): string {
  return edges.map(([a, b]) => `M${at(positions[a!]!)}L${at(positions[b!]!)}`).join("");
}

/** A dot at every node; none if nodes lie closer than `apart`. */
export function dotsOf(body: DrawnBody, apart: number): string {
  const { positions, edges, nodes } = body;
  if (positions.length < nodes) return "";
  const near = edges.some(([a, b]) => distance(positions[a!]!, positions[b!]!) < apart);
  return near ? "" : dots(positions);
}

export function branchesOf({ positions, edges }: DrawnBody): string {
  const degree = positions.map(() => 0);
  for (const edge of edges) for (const node of edge) degree[node]! += 1;
  return dots(positions.filter((_, i) => degree[i]! > 2));
}

const dots = (positions: number[][]) => positions.map((place) => `M${at(place)}h0`).join("");

function distance([ax, ay]: number[], [bx, by]: number[]): number {
  return Math.hypot(ax! - bx!, ay! - by!);
}

/** Shifts by whole worlds that show a part of the body, because the world is periodic. */
export function tilesOf({ positions }: DrawnBody, width: number, height: number): [number, number][] {
  const [left, right] = reach(
    positions.map(([x]) => x!),
    width,
  );
  const [low, high] = reach(
    positions.map(([, y]) => y!),
    height,
  );
  const tiles: [number, number][] = [];
  for (let i = left; i <= right; i++) {
    for (let j = low; j <= high; j++) tiles.push([i * width, j * height]);
  }
  return tiles;
}

/** The largest shift; a tangle far outside would need ever more. */
const FAR = 2;

function reach(places: number[], side: number): [number, number] {
  const [least, most] = [places.reduce((a, b) => Math.min(a, b)), places.reduce((a, b) => Math.max(a, b))];
  return [Math.max(-FAR, -Math.floor(most / side)), Math.min(FAR, -Math.floor(least / side))];
}
