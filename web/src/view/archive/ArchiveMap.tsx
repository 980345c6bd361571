/** The archive as a map: one cell an elite, to be looked at, pointed at and opened. */

import type { ComponentChildren, RefObject } from "preact";
import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Elite, Elites } from "../../live/elites";
import { useSize } from "../canvas";
import { prefersStillness, useTheme } from "../theme";
import { Horizontal, Vertical } from "./Axes";
import type { MapAxis } from "./axes";
import type { Colouring } from "./colouring";
import { FLASH_MS, MapPainter, type Picture } from "./draw";
import { Legend } from "./Legend";
import { type Direction, type Layout, isDirection, nextBin } from "./layout";
import type { Projection, Tiles } from "./projection";
import { Reading } from "./Reading";

export interface Looking {
  cell: number;
  elite: Elite;
}

interface Props {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  elites: Elites;
  colouring: Colouring;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  /** What else can be done with an elite. */
  actions: (elite: Elite) => ComponentChildren;
  /** The elite that is pointed at, else the marked one. */
  onLook: (looking: Looking | null) => void;
  /** What stands beside the cell that is looked at. */
  inset: ComponentChildren;
}

/** Cells are the archive's; bins are the map's, and each shows the best elite in it. */
export function ArchiveMap(props: Props) {
  const { axes, projection, elites, colouring, marked, onMark, onOpen, onLook, inset } = props;
  const { layout, tiles, bins } = projection;
  const plot = useRef<HTMLDivElement>(null);
  const [hovered, setHovered] = useState<number | null>(null);
  const from = marked === null ? null : (bins.get(marked) ?? null);
  const looked = hovered !== null && tiles.has(hovered) ? hovered : from;
  const tile = looked === null ? undefined : tiles.get(looked);
  const canvas = useDrawing(plot, { layout, tiles, colouring }, elites);
  useLayoutEffect(() => onLook(tile ? { cell: tile.cell, elite: tile.elite } : null), [tile?.elite]);

  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && from !== null) return onOpen(tiles.get(from)!.cell);
    if (!isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    const next = binByKey(event.key, from, tiles, layout);
    if (next !== null) onMark(tiles.get(next)!.cell);
  };
  const click = (event: MouseEvent) => {
    const bin = tileUnder(event, layout, tiles);
    if (bin === null) return;
    const { cell } = tiles.get(bin)!;
    // A finger cannot hover: its first tap looks, the second opens.
    if ((event as PointerEvent).pointerType === "touch" && bin !== from) onMark(cell);
    else onOpen(cell);
  };

  return (
    <div class="map">
      <Vertical axis={axes[1]} />
      <div
        ref={plot}
        class={`map-plot ${hovered === null ? "" : "over"}`}
        tabIndex={0}
        role="application"
        aria-label="Archive map. Arrow keys move between elites, Enter opens one."
        aria-describedby="map-reading"
        onPointerMove={(event) => {
          if (event.pointerType !== "touch") setHovered(tileUnder(event, layout, tiles));
        }}
        onPointerLeave={() => setHovered(null)}
        onClick={click}
        onKeyDown={press}
      >
        <canvas ref={canvas} />
        {looked !== null && tile && <Mark layout={layout} bin={looked} />}
        {looked !== null && tile && <Beside layout={layout} bin={looked} children={inset} />}
      </div>
      <Horizontal axis={axes[0]} />
      <Legend colouring={colouring} />
      <Reading tile={tile} axes={axes} colour={colouring.measure} onOpen={onOpen} actions={props.actions} />
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
function Mark({ layout, bin }: { layout: Layout; bin: number }) {
  const points = layout.outline(bin).map((spot) => spot.join()).join(" ");
  return (
    <svg class="map-mark" viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true">
      <polygon class="around" points={points} />
      <polygon points={points} />
    </svg>
  );
}

/** Stands where it hides neither the bin nor more of the map than it must. */
function Beside({ layout, bin, children }: { layout: Layout; bin: number; children: ComponentChildren }) {
  const [x, y] = layout.centre(bin);
  const side = x < 0.5 ? "right" : "left";
  return (
    <div class={`map-beside ${side}`} style={{ "--x": `${100 * x}%`, "--y": `${100 * y}%` }}>
      {children}
    </div>
  );
}

type Drawn = Pick<Picture, "layout" | "tiles" | "colouring">;

/** A canvas that always shows the picture, and flashes where it changed. */
function useDrawing(plot: RefObject<HTMLElement | null>, drawn: Drawn, elites: Elites) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const painter = useMemo(() => new MapPainter(), []);
  const size = useSize(plot);
  const theme = useTheme();
  const changed = useChanges(elites);
  useEffect(() => {
    const element = canvas.current;
    if (!element || size.width === 0) return;
    const picture = { ...drawn, theme, changed };
    const stop = animate((now) => {
      painter.draw(element, size, picture, now);
      return [...changed.values()].some((time) => now - time < FLASH_MS);
    });
    performance.clearMarks("map");
    performance.mark("map");
    return stop;
  }, [size, theme, changed, ...Object.values(drawn)]);
  return canvas;
}

/** When each cell last got another elite; what is there at first has not changed. */
function useChanges(elites: Elites): ReadonlyMap<number, number> {
  const seen = useRef<Elites | null>(null);
  const times = useRef<ReadonlyMap<number, number>>(new Map());
  if (seen.current !== elites) {
    const before = seen.current;
    const now = performance.now();
    const next = new Map([...times.current].filter(([, time]) => now - time < FLASH_MS));
    for (const [cell, elite] of before && !prefersStillness() ? elites : []) {
      if (before!.get(cell)?.creature !== elite.creature) next.set(cell, now);
    }
    seen.current = elites;
    times.current = next;
  }
  return times.current;
}

/** Draws a picture at once, and again with every frame for as long as `draw` asks for it. */
function animate(draw: (now: number) => boolean): () => void {
  let frame = 0;
  const step = () => {
    if (draw(performance.now())) frame = requestAnimationFrame(step);
  };
  step();
  return () => cancelAnimationFrame(frame);
}
