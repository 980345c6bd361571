/** The archive as a map: one cell an elite, to be looked at, pointed at and opened. */

import type { RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Elites } from "../../live/elites";
import { useSize } from "../canvas";
import { count, number, short, words } from "../format";
import { prefersStillness, useTheme } from "../theme";
import { Horizontal, Vertical } from "./Axes";
import { FITNESS, type MapAxis } from "./axes";
import { type ColourBy, FLASH_MS, type Picture, drawCells, rangeOf } from "./draw";
import { type Direction, type Shape, cellAt, nextCell } from "./geometry";
import { Legend } from "./Legend";
import { type Tile, type Tiles, project } from "./projection";

interface Props {
  axes: readonly [MapAxis, MapAxis];
  elites: Elites;
  colourBy: ColourBy;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
}

const INKS = {
  light: { ink: "#0b1216", ground: "#ffffff", empty: "rgb(20 50 70 / 0.055)" },
  dark: { ink: "#f4f8fa", ground: "#0b1216", empty: "rgb(180 215 235 / 0.055)" },
};

/** Cells are the archive's; bins are the map's, and each shows the best elite in it. */
export function ArchiveMap({ axes, elites, colourBy, marked, onMark, onOpen }: Props) {
  const plot = useRef<HTMLDivElement>(null);
  const [hovered, setHovered] = useState<number | null>(null);
  const { shape, tiles, bins } = useMemo(() => project(elites, axes), [elites, ...axes]);
  const range = useMemo(() => rangeOf(tiles, colourBy), [tiles, colourBy]);
  const from = marked === null ? null : (bins.get(marked) ?? null);
  const looked = hovered ?? from;
  const tile = looked === null ? undefined : tiles.get(looked);
  const picture = { shape, tiles, colourBy, range, marked: looked };
  const canvas = useDrawing(plot, picture, elites);

  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && from !== null) return onOpen(tiles.get(from)!.cell);
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    setHovered(null);
    const next = binByKey(event.key as Direction, from, tiles, shape);
    if (next !== null) onMark(tiles.get(next)!.cell);
  };
  const open = (event: MouseEvent) => {
    const bin = tileUnder(event, shape, tiles);
    if (bin !== null) onOpen(tiles.get(bin)!.cell);
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
        onPointerMove={(event) => setHovered(tileUnder(event, shape, tiles))}
        onPointerLeave={() => setHovered(null)}
        onClick={open}
        onKeyDown={press}
      >
        <canvas ref={canvas} />
      </div>
      <Horizontal axis={axes[0]} />
      <Legend label={words(colourBy)} range={range} whole={colourBy === "generation"} />
      <Reading tile={tile} axes={axes} />
    </div>
  );
}

/** The bin under the pointer, where it holds an elite. */
function tileUnder(event: MouseEvent, shape: Shape, tiles: Tiles): number | null {
  const box = (event.currentTarget as Element).getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const bin = cellAt(x / box.width, y / box.height, shape);
  return bin !== null && tiles.has(bin) ? bin : null;
}

/** Where an arrow key leads; from nowhere, to the best elite. */
function binByKey(key: Direction, from: number | null, tiles: Tiles, shape: Shape) {
  if (from !== null) return nextCell(from, key, tiles.keys(), shape);
  const ranked = [...tiles].sort(([, a], [, b]) => b.elite.fitness - a.elite.fitness);
  return ranked[0]?.[0] ?? null;
}

type Drawn = Pick<Picture, "shape" | "tiles" | "colourBy" | "range" | "marked">;

/** A canvas that always shows the picture, and flashes where it changed. */
function useDrawing(plot: RefObject<HTMLElement | null>, drawn: Drawn, elites: Elites) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(plot);
  const theme = useTheme();
  const changed = useChanges(elites);
  useEffect(() => {
    const element = canvas.current;
    if (!element || size.width === 0) return;
    const picture = { ...drawn, ...INKS[theme], changed };
    return animate((now) => {
      drawCells(element, size, picture, now);
      return [...changed.values()].some((time) => now - time < FLASH_MS);
    });
  }, [size, theme, changed, ...Object.values(drawn)]);
  return canvas;
}

function Reading({ tile, axes }: { tile: Tile | undefined; axes: readonly MapAxis[] }) {
  if (!tile) {
    return (
      <p id="map-reading" class="map-reading" aria-live="polite">
        <span class="quiet">Point at a cell to read it, click it to see its creature swim.</span>
      </p>
    );
  }
  const { elite, behind } = tile;
  return (
    <p id="map-reading" class="map-reading" aria-live="polite">
      <span>
        Fitness <b>{number(elite.fitness)}</b>
      </span>
      {axes
        .filter(({ name }) => name !== FITNESS)
        .map((axis) => (
          <span key={axis.name}>
            {axis.title} <b>{number(axis.valueOf(elite))}</b>
          </span>
        ))}
      <span>
        Generation <b>{elite.generation}</b>
      </span>
      {behind > 0 && (
        <span>
          best of <b>{count(behind + 1)}</b> here
        </span>
      )}
      <code>{short(elite.creature)}</code>
    </p>
  );
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
