/** The lines and dots of a body that is drawn, in cells. */

import type { DrawnBody } from "../api/types";

/** Cells between the lines of the grid. */
export const GRID = 8;

const at = ([x, y]: number[]) => `${x} ${y}`;

export function linesOf({ positions, edges }: DrawnBody): string {
  return edges.map(([a, b]) => `M${at(positions[a!]!)}L${at(positions[b!]!)}`).join("");
}

/** A dot at every node, where nodes lie far enough apart to be told from each other. */
export function dotsOf(body: DrawnBody, apart: number): string {
  const { positions, edges, nodes } = body;
  if (positions.length < nodes) return "";
  const near = edges.some(([a, b]) => distance(positions[a!]!, positions[b!]!) < apart);
  return near ? "" : dots(positions);
}

/** A dot where three filaments or more meet. */
export function branchesOf({ positions, edges }: DrawnBody): string {
  const degree = positions.map(() => 0);
  for (const edge of edges) for (const node of edge) degree[node]! += 1;
  return dots(positions.filter((_, i) => degree[i]! > 2));
}

const dots = (positions: number[][]) => positions.map((place) => `M${at(place)}h0`).join("");

function distance([ax, ay]: number[], [bx, by]: number[]): number {
  return Math.hypot(ax! - bx!, ay! - by!);
}

/** Shifts by whole worlds in which some of the body is seen: the world is periodic. */
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

/** The farthest worlds that are looked at: a tangle far outside would need ever more. */
const FAR = 2;

function reach(places: number[], side: number): [number, number] {
  const [least, most] = [places.reduce((a, b) => Math.min(a, b)), places.reduce((a, b) => Math.max(a, b))];
  return [Math.max(-FAR, -Math.floor(most / side)), Math.min(FAR, -Math.floor(least / side))];
}
