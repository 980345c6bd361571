/** The archive as a map: one cell an elite, to be looked at, pointed at and opened. */

import type { RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Axis } from "../../api/types";
import type { Elite, Elites } from "../../live/elites";
import { useSize } from "../canvas";
import { number, short, words } from "../format";
import { prefersStillness, useTheme } from "../theme";
import { Horizontal, Vertical } from "./Axes";
import { type ColourBy, FLASH_MS, type Picture, drawCells, rangeOf } from "./draw";
import { type Direction, type Shape, cellAt, nextCell } from "./geometry";
import { Legend } from "./Legend";

interface Props {
  axes: [Axis, Axis];
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

export function ArchiveMap({ axes, elites, colourBy, marked, onMark, onOpen }: Props) {
  const plot = useRef<HTMLDivElement>(null);
  const [hovered, setHovered] = useState<number | null>(null);
  const shape = useMemo<Shape>(() => [axes[0].bins, axes[1].bins], [axes]);
  const range = useMemo(() => rangeOf(elites, colourBy), [elites, colourBy]);
  const looked = hovered ?? marked;
  const elite = looked === null ? undefined : elites.get(looked);
  const canvas = useDrawing(plot, { shape, elites, colourBy, range, marked: looked });

  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && marked !== null && elites.has(marked)) return onOpen(marked);
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    setHovered(null);
    const next = cellByKey(event.key as Direction, marked, elites, shape);
    if (next !== null) onMark(next);
  };
  const open = (event: MouseEvent) => {
    const cell = eliteUnder(event, shape, elites);
    if (cell !== null) onOpen(cell);
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
        onPointerMove={(event) => setHovered(eliteUnder(event, shape, elites))}
        onPointerLeave={() => setHovered(null)}
        onClick={open}
        onKeyDown={press}
      >
        <canvas ref={canvas} />
      </div>
      <Horizontal axis={axes[0]} />
      <Legend label={words(colourBy)} range={range} whole={colourBy === "generation"} />
      <Reading elite={elite} axes={axes} />
    </div>
  );
}

/** The cell under the pointer, where it holds an elite. */
function eliteUnder(event: MouseEvent, shape: Shape, elites: Elites): number | null {
  const box = (event.currentTarget as Element).getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const cell = cellAt(x / box.width, y / box.height, shape);
  return cell !== null && elites.has(cell) ? cell : null;
}

/** Where an arrow key leads; from nowhere, to the best elite. */
function cellByKey(key: Direction, from: number | null, elites: Elites, shape: Shape) {
  if (from !== null) return nextCell(from, key, elites.keys(), shape);
  const ranked = [...elites].sort(([, a], [, b]) => b.fitness - a.fitness);
  return ranked[0]?.[0] ?? null;
}

type Drawn = Pick<Picture, "shape" | "elites" | "colourBy" | "range" | "marked">;

/** A canvas that always shows the picture, and flashes where it changed. */
function useDrawing(plot: RefObject<HTMLElement | null>, drawn: Drawn) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(plot);
  const theme = useTheme();
  const changed = useChanges(drawn.elites);
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

function Reading({ elite, axes }: { elite: Elite | undefined; axes: [Axis, Axis] }) {
  return (
    <p id="map-reading" class="map-reading" aria-live="polite">
      {elite ? (
        <>
          <span>
            Fitness <b>{number(elite.fitness)}</b>
          </span>
          {axes.map((axis, k) => (
            <span key={axis.name}>
              {words(axis.name)} <b>{number(elite.descriptors[k])}</b>
            </span>
          ))}
          <span>
            Generation <b>{elite.generation}</b>
          </span>
          <code>{short(elite.creature)}</code>
        </>
      ) : (
        <span class="quiet">Point at a cell to read it, click it to see its creature swim.</span>
      )}
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
