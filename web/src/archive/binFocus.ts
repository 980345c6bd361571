/** The focused bin of a map or gallery: under the pointer, or marked and moved by keys. */

import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import { type Elite, fittest } from "../store/elites";
import type { MapAxis } from "./axes";
import type { Colouring } from "./colouring";
import { type Direction, type Layout, isDirection, nextBin } from "./layout";
import { type Projection, type Tiles, tileWith } from "./projection";
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
  /** True if a click on a bin with several elites marks it, which lists them. */
  lists: boolean;
}

/** `onMove` gets the bin after an arrow key. */
export function useBinFocus(
  { projection, marked, selected, onSelect, onMark, onOpen, lists }: ArchiveViewProps,
  onMove?: (bin: number) => void,
) {
  const { layout, tiles, bins } = projection;
  const [hovered, setHovered] = useState<number | null>(null);
  /** The bin of the marked cell. */
  const markedBin = marked === null ? null : (bins.get(marked) ?? null);
  /** The bin under the pointer, or the marked one. */
  const focused = hovered !== null && tiles.has(hovered) ? hovered : markedBin;
  const tile = focused === null ? undefined : tileWith(projection, focused, marked);
  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && markedBin !== null) return onOpen(marked!);
    const next = isDirection(event.key) ? binByKey(event.key, markedBin, tiles, layout) : null;
    const changed = onSelect && selectByKey(event, selected, projection, markedBin, next);
    if (changed) onSelect(changed);
    if (!changed && !isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    if (next === null) return;
    onMark(tiles.get(next)!.cell);
    onMove?.(next);
  };
  /** Open the elite of a bin, or only mark it. */
  const click = (bin: number, byTouch: boolean) => {
    const { cell, hidden } = tileWith(projection, bin, marked)!;
    // Fingers cannot hover: the first tap marks, the second opens.
    const marks = byTouch || (lists && hidden > 0);
    if (marks && bin !== markedBin) onMark(cell);
    else onOpen(cell);
  };
  return { hovered, setHovered, markedBin, focused, tile, press, click };
}

/** The bin after an arrow key; without a start, that of the best elite. */
function binByKey(key: Direction, markedBin: number | null, tiles: Tiles, layout: Layout) {
  if (markedBin !== null) return nextBin(markedBin, key, tiles.keys(), layout);
  return fittest([...tiles].map(([bin, { elite }]) => [bin, elite] as const))?.[0] ?? null;
}

/** The bin at the pointer, if it has an elite; the element has the size of the map. */
export function tileUnder(event: MouseEvent, element: Element, { layout, tiles }: Projection) {
  const { left, top, width, height } = element.getBoundingClientRect();
  const bin = layout.at((event.clientX - left) / width, (event.clientY - top) / height);
  return bin !== null && tiles.has(bin) ? bin : null;
}
