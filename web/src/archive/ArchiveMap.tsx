/** The archive as a map of cells, which can be pointed at, selected and opened. */

import type { ComponentChildren } from "preact";
import { useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Elite, Elites } from "../store/elites";
import { HorizontalLabels, VerticalLabels } from "./AxisLabels";
import type { MapAxis } from "./axes";
import {
  type Box,
  type Selection,
  isAdditive,
  binsOf,
  binsWithin,
  union,
  cellsIn,
  selectByKey,
  keyHelp,
  toggle,
} from "./selection";
import type { Colouring } from "./colouring";
import { useBoxSelect } from "./boxSelect";
import { useMapCanvas } from "./mapCanvas";
import { ColourLegend } from "./ColourLegend";
import { type Direction, type Layout, isDirection, nextBin } from "./layout";
import type { Projection, Tiles } from "./projection";
import { EliteReading } from "./EliteReading";
import { text } from "./text";

export interface HoveredElite {
  cell: number;
  elite: Elite;
}

interface Props extends Selection {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  elites: Elites;
  colouring: Colouring;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  /** What else can be done with an elite. */
  actions: (elite: Elite, cell: number) => ComponentChildren;
  /** The elite that is pointed at, else the marked one. */
  onLook: (looking: HoveredElite | null) => void;
  /** What stands beside the cell that is looked at. */
  inset: ComponentChildren;
}

/** Cells are the archive's; bins are the map's, and each shows the best elite in it. */
export function ArchiveMap(props: Props) {
  const { axes, projection, elites, colouring, marked, onMark, onOpen, onLook, onChoose, inset } = props;
  const { layout, tiles, bins } = projection;
  const plot = useRef<HTMLDivElement>(null);
  const [hovered, setHovered] = useState<number | null>(null);
  const from = marked === null ? null : (bins.get(marked) ?? null);
  const looked = hovered !== null && tiles.has(hovered) ? hovered : from;
  const tile = looked === null ? undefined : tiles.get(looked);
  const drag = useBoxSelect(onChoose !== null, (box, event) => {
    const inside = cellsIn(binsWithin(box, layout, tiles), projection);
    onChoose!(isAdditive(event) ? union(props.chosen, inside) : inside);
  });
  const chosen = useMemo(
    () => (drag.box ? new Set(binsWithin(drag.box, layout, tiles)) : binsOf(props.chosen, projection)),
    [drag.box, props.chosen, projection],
  );
  const canvas = useMapCanvas(plot, { layout, tiles, colouring, chosen }, elites);
  useLayoutEffect(() => onLook(tile ? { cell: tile.cell, elite: tile.elite } : null), [tile?.elite]);

  const press = (event: KeyboardEvent) => {
    if (drag.box) return;
    if (event.key === "Enter" && from !== null) return onOpen(tiles.get(from)!.cell);
    const next = isDirection(event.key) ? binByKey(event.key, from, tiles, layout) : null;
    const changed = onChoose && selectByKey(event, props.chosen, projection, from, next);
    if (changed) onChoose(changed);
    if (!changed && !isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    if (next !== null) onMark(tiles.get(next)!.cell);
  };
  const click = (event: MouseEvent) => {
    const bin = tileUnder(event, layout, tiles);
    if (bin === null || drag.wasDrag()) return;
    if (onChoose && isAdditive(event)) return onChoose(toggle(props.chosen, cellsIn([bin], projection)));
    const { cell } = tiles.get(bin)!;
    // A finger cannot hover: its first tap looks, the second opens.
    if ((event as PointerEvent).pointerType === "touch" && bin !== from) onMark(cell);
    else onOpen(cell);
  };

  return (
    <div class="map">
      <VerticalLabels axis={axes[1]} />
      <div
        ref={plot}
        class={`map-plot ${hovered === null ? "" : "over"}`}
        tabIndex={0}
        role="application"
        aria-label={text.mapLabel(keyHelp(props))}
        aria-describedby="map-reading"
        {...drag.handlers}
        onPointerMove={(event) => {
          if (drag.onMove(event)) setHovered(null);
          else if (event.pointerType !== "touch") setHovered(tileUnder(event, layout, tiles));
        }}
        onPointerLeave={() => setHovered(null)}
        onClick={click}
        onKeyDown={press}
      >
        <canvas ref={canvas} />
        {looked !== null && tile && <BinOutline layout={layout} bin={looked} />}
        {drag.box && <SelectionBox {...drag.box} />}
        {looked !== null && tile && !drag.box && (
          <PlacedBeside layout={layout} bin={looked} children={inset} />
        )}
      </div>
      <HorizontalLabels axis={axes[0]} />
      <ColourLegend colouring={colouring} />
      <EliteReading
        {...{ tile, axes, onOpen }}
        colour={colouring.measure}
        hint={text.mapHint(onChoose !== null)}
        actions={props.actions}
      />
    </div>
  );
}

/** The bin under the pointer, where it holds an elite. */
export function tileUnder(event: MouseEvent, layout: Layout, tiles: Tiles): number | null {
  const box = (event.currentTarget as Element).getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const bin = layout.at(x / box.width, y / box.height);
  return bin !== null && tiles.has(bin) ? bin : null;
}

/** Where an arrow key leads; from nowhere, to the best elite. */
export function binByKey(key: Direction, from: number | null, tiles: Tiles, layout: Layout) {
  if (from !== null) return nextBin(from, key, tiles.keys(), layout);
  let best: number | null = null;
  for (const [bin, { elite }] of tiles) {
    if (best === null || elite.fitness > tiles.get(best)!.elite.fitness) best = bin;
  }
  return best;
}

/** The outline of the bin that is looked at, above the picture. */
function BinOutline({ layout, bin }: { layout: Layout; bin: number }) {
  const points = layout
    .outline(bin)
    .map((spot) => spot.join())
    .join(" ");
  return (
    <svg class="map-mark" viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true">
      <polygon class="around" points={points} />
      <polygon points={points} />
    </svg>
  );
}

/** The box that is being drawn. */
function SelectionBox({ from, to }: Box) {
  const [x, y] = [Math.min(from[0], to[0]), Math.min(from[1], to[1])];
  const [width, height] = [Math.abs(from[0] - to[0]), Math.abs(from[1] - to[1])];
  return (
    <svg class="map-mark" viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true">
      <rect {...{ x, y, width, height }} />
    </svg>
  );
}

/** Stands where it hides neither the bin nor more of the map than it must. */
function PlacedBeside({
  layout,
  bin,
  children,
}: {
  layout: Layout;
  bin: number;
  children: ComponentChildren;
}) {
  const [x, y] = layout.centre(bin);
  const side = x < 0.5 ? "right" : "left";
  return (
    <div class={`map-beside ${side}`} style={{ "--x": `${100 * x}%`, "--y": `${100 * y}%` }}>
      {children}
    </div>
  );
}
