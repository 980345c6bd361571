/** Keys of a tree: move along lines of descent, move the window, zoom. */

import { type Phylogeny, NONE } from "../decode/phylogeny";
import { relativeAt } from "./nearest";
import type { Stage } from "./stage";
import type { LoadedTree } from "./useTree";

/** Enlargement of a step, as its natural logarithm. */
export const ZOOM_STEP = Math.log(1.6);

const ZOOMS: Record<string, number> = { "+": ZOOM_STEP, "=": ZOOM_STEP, "-": -ZOOM_STEP };
/** Pixels by which the window moves. */
const PAN: Record<string, readonly [number, number]> = {
  ArrowLeft: [80, 0],
  ArrowRight: [-80, 0],
  ArrowUp: [0, 80],
  ArrowDown: [0, -80],
};

interface Selection {
  selected: number;
  select: (creature: number) => void;
  open: (creature: number) => void;
}

/** Carry out a key; false if it means nothing here. */
export function press(
  { key, shiftKey }: Pick<KeyboardEvent, "key" | "shiftKey">,
  { tree, layout }: LoadedTree,
  stage: Pick<Stage, "zoom" | "all" | "pan" | "reveal">,
  { selected, select, open }: Selection,
): boolean {
  const zoom = ZOOMS[key];
  const direction = PAN[key];
  if (zoom) stage.zoom(zoom);
  else if (key === "0") stage.all();
  else if (key === "Escape") select(NONE);
  else if (key === "Enter" && selected !== NONE) open(selected);
  else if (direction && shiftKey) stage.pan(direction);
  else if (direction) {
    const next = selected === NONE ? fittest(tree, layout.row) : relativeAt(layout, tree, selected, key);
    if (next === NONE) return false;
    select(next);
    stage.reveal(next);
  } else return false;
  return true;
}

function fittest({ fitness, count }: Phylogeny, row: Int32Array): number {
  let best = NONE;
  for (let i = 0; i < count; i++) {
    if (row[i] !== NONE && (best === NONE || fitness[i]! > fitness[best]!)) best = i;
  }
  return best;
}
