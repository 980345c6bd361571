/** The focused bin of a map or gallery: under the pointer, or marked and moved by keys. */

import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import { type Elite, fittest } from "../store/elites";
import type { MapAxis } from "./axes";
import type { Colouring } from "./colouring";
import { type Direction, type Layout, isDirection, nextBin } from "./layout";
import type { Projection, Tile, Tiles } from "./projection";
import { type Selection, selectByKey } from "./selection";

/** Props of both map and gallery. */
export interface ArchiveViewProps extends Selection {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  /** The cell in the address. */
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
  /** The bin under the pointer, or the marked one, and its tile. */
  focused: number | null;
  tile: Tile | undefined;
  press: (event: KeyboardEvent) => void;
}

/** `onMove` gets the bin after an arrow key. */
export function useBinFocus(
  { projection, marked, selected, onSelect, onMark, onOpen }: ArchiveViewProps,
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
    const changed = onSelect && selectByKey(event, selected, projection, from, next);
    if (changed) onSelect(changed);
    if (!changed && !isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    if (next === null) return;
    onMark(tiles.get(next)!.cell);
    onMove?.(next);
  };
  return { hovered, setHovered, from, focused, tile, press };
}

/** The bin after an arrow key; without a start, that of the best elite. */
function binByKey(key: Direction, from: number | null, tiles: Tiles, layout: Layout) {
  if (from !== null) return nextBin(from, key, tiles.keys(), layout);
  return fittest([...tiles].map(([bin, { elite }]) => [bin, elite] as const))?.[0] ?? null;
}
