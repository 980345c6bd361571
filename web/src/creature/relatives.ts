/** A creature between its ancestors and its children, as columns of names and lines. */

import type { Ancestors, Children, Relative } from "../api/types";
import { text } from "./text";

export interface PlacedRelative {
  relative: Relative;
  x: number;
  y: number;
}

export interface FamilyLayout {
  width: number;
  height: number;
  kin: PlacedRelative[];
  /** From a parent to its child. */
  lines: [PlacedRelative, PlacedRelative][];
  /** Of each column its middle and what stands in it. */
  columns: { x: number; title: string }[];
  hidden: number;
}

/** Parents, oneself and children fit on a phone. */
export const [WIDE, HIGH] = [92, 34];
const GAP = 20;
/** Children, or ancestors of one generation, that are drawn. */
const MOST = 8;

/** Children come as the fittest first, and ancestors as the nearest. */
export function familyLayoutOf(self: Relative, ancestors: Ancestors, children: Children): FamilyLayout {
  const deepest = Math.max(0, ...ancestors.items.map(({ distance }) => distance));
  const levels = Array.from({ length: deepest }, (_, i) =>
    ancestors.items.filter(({ distance }) => distance === deepest - i),
  );
  const below = children.items.length > 0 ? [children.items] : [];
  const columns = [...levels, [self], ...below].map((level) => level.slice(0, MOST));
  const height = HIGH * Math.max(...columns.map((column) => column.length));
  const kin = columns.flatMap((column, i) =>
    column.map((relative, k) => ({
      relative,
      x: i * (WIDE + GAP),
      y: (height * (k + 0.5)) / column.length,
    })),
  );
  return {
    width: columns.length * (WIDE + GAP) - GAP,
    height,
    kin,
    lines: linesOf(kin, self, ancestors),
    columns: columns.map((_, i) => ({ x: i * (WIDE + GAP), title: titleOf(deepest - i) })),
    hidden: children.total - Math.min(MOST, children.items.length),
  };
}

function linesOf(
  kin: PlacedRelative[],
  self: Relative,
  { parents }: Ancestors,
): [PlacedRelative, PlacedRelative][] {
  const byName = new Map(kin.map((one) => [one.relative.creature, one]));
  const me = byName.get(self.creature)!;
  return kin.flatMap((child): [PlacedRelative, PlacedRelative][] => {
    // Of a child's parents only this creature has a place beside it.
    if (child.x > me.x) return [[me, child]];
    const names = child === me ? parents : child.relative.parents;
    return [...new Set(names)]
      .flatMap((name) => byName.get(name) ?? [])
      .filter((parent) => parent.x < child.x)
      .map((parent) => [parent, child]);
  });
}

const TITLES = [text.thisCreature, text.parents, text.grandparents];

function titleOf(distance: number): string {
  if (distance < 0) return text.children;
  return TITLES[distance] ?? text.generationsBack(distance);
}
