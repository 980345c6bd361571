/** Layout of a family tree: ancestors, the creature and its children in columns. */

import type { Ancestors, Children, Relative } from "../api/types";
import { text } from "./text";

export interface PlacedRelative {
  relative: Relative;
  x: number;
  y: number;
}

export type FamilyLayout = ReturnType<typeof familyLayoutOf>;
type Line = [parent: PlacedRelative, child: PlacedRelative];

/** Size of a name, in pixels: parents, creature and children fit on a phone. */
export const [COLUMN_WIDTH, ROW_HEIGHT] = [92, 34];
const GAP = 20;
/** Relatives drawn per generation. */
const MAX_PER_COLUMN = 8;

/** Children are sorted by fitness, ancestors by distance. */
export function familyLayoutOf(self: Relative, ancestors: Ancestors, children: Children) {
  const deepest = Math.max(0, ...ancestors.items.map(({ distance }) => distance));
  const levels = Array.from({ length: deepest }, (_, i) =>
    ancestors.items.filter(({ distance }) => distance === deepest - i),
  );
  const below = children.items.length > 0 ? [children.items] : [];
  const columns = [...levels, [self], ...below].map((level) => level.slice(0, MAX_PER_COLUMN));
  const height = ROW_HEIGHT * Math.max(...columns.map((column) => column.length));
  const relatives = columns.flatMap((column, i) =>
    column.map((relative, k) => ({
      relative,
      x: i * (COLUMN_WIDTH + GAP),
      y: (height * (k + 0.5)) / column.length,
    })),
  );
  return {
    width: columns.length * (COLUMN_WIDTH + GAP) - GAP,
    height,
    relatives,
    lines: linesOf(relatives, self, ancestors),
    columns: columns.map((_, i) => ({ x: i * (COLUMN_WIDTH + GAP), title: titleOf(deepest - i) })),
    hidden: children.total - Math.min(MAX_PER_COLUMN, children.items.length),
  };
}

function linesOf(relatives: PlacedRelative[], self: Relative, { parents }: Ancestors): Line[] {
  const byName = new Map(relatives.map((one) => [one.relative.creature, one]));
  const me = byName.get(self.creature)!;
  return relatives.flatMap((child): Line[] => {
    // Other parents of a child are not shown.
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
