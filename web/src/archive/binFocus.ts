/** The bin of a map or gallery that is pointed at or marked, and the keys that move it. */

import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import type { Elite } from "../store/elites";
import type { MapAxis } from "./axes";
import type { Colouring } from "./colouring";
import { type Direction, type Layout, isDirection, nextBin } from "./layout";
import type { Projection, Tile, Tiles } from "./projection";
import { type Selection, selectByKey } from "./selection";

/** What a map and a gallery are given alike. */
export interface ArchiveViewProps extends Selection {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  /** The cell that the address names. */
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  /** Further links and buttons for an elite. */
  actions: (elite: Elite, cell: number) => ComponentChildren;
}

interface BinFocus {
  hovered: number | null;
  setHovered: (bin: number | null) => void;
  /** The bin of the marked cell. */
  from: number | null;
  /** The bin that is pointed at, else the marked one, and its tile. */
  focused: number | null;
  tile: Tile | undefined;
  press: (event: KeyboardEvent) => void;
}

/** `onMove` is told of the bin that an arrow key leads to. */
export function useBinFocus(
  { projection, marked, chosen, onChoose, onMark, onOpen }: ArchiveViewProps,
  onMove?: (bin: number) => void,
): BinFocus {
  const { layout, tiles, bins } = projection;
  const [hovered, setHovered] = useState<number | null>(null);
  const from = marked === null ? null : (bins.get(marked) ?? null);
  const focused = hovered !== null && tiles.has(hovered) ? hovered : from;
  const tile = focused === null ? undefined : tiles.get(focused);
  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && from !== null) return onOpen(tiles.get(from)!.cell);
    const next = isDirection(event.key) ? binByKey(event.key, from, tiles, layout) : null;
    const changed = onChoose && selectByKey(event, chosen, projection, from, next);
    if (changed) onChoose(changed);
    if (!changed && !isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    if (next === null) return;
    onMark(tiles.get(next)!.cell);
    onMove?.(next);
  };
  return { hovered, setHovered, from, focused, tile, press };
}

/** The bin that an arrow key leads to; from nowhere, that of the best elite. */
function binByKey(key: Direction, from: number | null, tiles: Tiles, layout: Layout) {
  if (from !== null) return nextBin(from, key, tiles.keys(), layout);
  let best: number | null = null;
  for (const [bin, { elite }] of tiles) {
    if (best === null || elite.fitness > tiles.get(best)!.elite.fitness) best = bin;
  }
  return best;
}
