/** The body plan of a creature: its place in a picture, and its genes in words. */

import type { PlanDrawing, PlanSegment } from "../api/types";
import { number, percent } from "../ui/format";
import { text } from "./text";

export interface PlanPicture {
  width: number;
  height: number;
  /** Pixels of a cell. */
  scale: number;
  /** The place of each node; y goes downwards. */
  at: [x: number, y: number][];
}

/** The longer side of a body, in pixels, unless its cells would be too large. */
const SIDE = 380;
const MAX_CELL = 26;
const MARGIN = 34;

export function pictureOf({ nodes }: PlanDrawing): PlanPicture {
  const [left, right] = endsOf(nodes.map(({ x }) => x));
  const [low, high] = endsOf(nodes.map(({ y }) => y));
  const scale = Math.min(MAX_CELL, SIDE / Math.max(right - left, high - low, 1));
  return {
    width: scale * (right - left) + 2 * MARGIN,
    height: scale * (high - low) + 2 * MARGIN,
    scale,
    at: nodes.map(({ x, y }) => [scale * (x - left) + MARGIN, scale * (high - y) + MARGIN]),
  };
}

const endsOf = (values: number[]) => [Math.min(...values), Math.max(...values)] as const;

/** The edges of each segment; an edge belongs to the segment of its later node. */
export function edgesOf({ nodes, edges }: PlanDrawing, segment: number): [number, number][] {
  return edges.filter(([a, b]) => nodes[Math.max(a, b)]!.segment === segment) as [number, number][];
}

/** The distance of a number from its node, in pixels. */
const BESIDE = 15;

/** The place of a segment's number: beside the segment, on the side that looks away from the body's middle. */
export function numberPlace(
  plan: PlanDrawing,
  { at, width, height }: PlanPicture,
  segment: number,
): { x: number; y: number } | null {
  const row = namedNode(plan, segment);
  if (row === null) return null;
  const [x, y] = at[row]!;
  const edge = edgesOf(plan, segment).find((ends) => ends.includes(row));
  const [a, b] = (edge ?? [row, row]).map((end) => at[end]!) as [[number, number], [number, number]];
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(dx, dy) || 1;
  const outward = -dy * (x - width / 2) + dx * (y - height / 2) > 0 ? 1 : -1;
  return { x: x - (outward * BESIDE * dy) / length, y: y + (outward * BESIDE * dx) / length };
}

/**
 * The node beside which a segment is named: near the middle of its first copy, away from branches if it can
 * be; null if the segment has not grown.
 */
export function namedNode({ nodes, edges }: PlanDrawing, segment: number): number | null {
  const rows = nodes.flatMap((node, row) => (node.segment === segment && node.copy === 0 ? [row] : []));
  const middle = rows[Math.floor(rows.length / 2)] ?? null;
  if (middle === null) return null;
  const plain = rows.filter((row) => edges.filter((ends) => ends.includes(row)).length <= 2);
  const nearest = plain.sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle));
  return nearest[0] ?? middle;
}

export const nameOf = (segment: number) => (segment === 0 ? text.root : text.segment(segment + 1));

export const isRoot = ({ parent }: PlanSegment) => parent === null;

export const placeOf = ({ parent, place }: PlanSegment) =>
  parent === null ? null : text.attached(nameOf(parent), percent(rounded(place)));

export const shortPlaceOf = ({ parent, place }: PlanSegment) =>
  parent === null ? text.rootShort : text.attachedShort(parent + 1, percent(rounded(place)));

const rounded = (place: number) => Math.round(100 * place) / 100;

/** The genes that not every segment has. */
export function kindOf(segment: PlanSegment): string {
  const kinds = [
    segment.ring && text.ring,
    segment.mirrored && !isRoot(segment) && text.mirrored,
    segment.copies > 1 && !isRoot(segment) && text.copies(segment.copies),
  ];
  return kinds.filter(Boolean).join(", ");
}

/** The number of copies in the body, or the reason why there are none. */
export function grownOf(segment: PlanSegment, { segments }: PlanDrawing): string {
  if (segment.grown > 0) return String(segment.grown);
  const parent = segment.parent === null ? null : segments[segment.parent]!;
  return parent?.grown === 0 ? text.parentUngrown : text.noRoom;
}

export const degrees = (angle: number) => text.degrees(number(Math.round(angle) + 0));

/** One sentence on a segment. */
export function about(index: number, plan: PlanDrawing): string {
  const segment = plan.segments[index]!;
  const { nodes, angle, curl, stiffness, ring } = segment;
  const genes = [
    text.nodes(nodes),
    placeOf(segment),
    !isRoot(segment) && text.angleIs(degrees(angle)),
    !ring && text.curlIs(degrees(curl)),
    text.stiffnessIs(number(stiffness)),
    kindOf(segment),
    segment.grown > 0 ? text.inBody(segment.grown) : grownOf(segment, plan),
  ];
  return text.segmentIs(nameOf(index), genes.filter(Boolean).join(", "));
}
