/** The archive as a map: one cell an elite, to be looked at, pointed at and opened. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Axis } from "../../api/types";
import type { Elite, Elites } from "../../live/elites";
import { useSize } from "../canvas";
import { number, short, words } from "../format";
import { prefersStillness, useTheme } from "../theme";
import { Horizontal, Vertical } from "./Axes";
import { type ColourBy, FLASH_MS, drawCells, rangeOf } from "./draw";
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

const INK = { light: "#0b1216", dark: "#f4f8fa" };
const EMPTY = { light: "rgb(20 50 70 / 0.055)", dark: "rgb(180 215 235 / 0.055)" };

export function ArchiveMap({ axes, elites, colourBy, marked, onMark, onOpen }: Props) {
  const plot = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(plot);
  const theme = useTheme();
  const [hovered, setHovered] = useState<number | null>(null);
  const shape = useMemo<Shape>(() => [axes[0].bins, axes[1].bins], [axes]);
  const range = useMemo(() => rangeOf(elites, colourBy), [elites, colourBy]);
  const changed = useChanges(elites);
  const looked = hovered ?? marked;

  useEffect(() => {
    const element = canvas.current;
    if (!element || size.width === 0) return;
    const picture = {
      shape,
      elites,
      colourBy,
      range,
      changed,
      marked: looked,
      ink: INK[theme],
      empty: EMPTY[theme],
    };
    return animate((now) => {
      drawCells(element, size, picture, now);
      return [...changed.values()].some((time) => now - time < FLASH_MS);
    });
  }, [size, shape, elites, colourBy, range, changed, looked, theme]);

  const filledCellAt = (event: MouseEvent) => {
    const box = plot.current!.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const cell = cellAt(x / box.width, y / box.height, shape);
    return cell !== null && elites.has(cell) ? cell : null;
  };
  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && marked !== null && elites.has(marked)) return onOpen(marked);
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    const start = marked ?? best(elites);
    const direction = event.key as Direction;
    const next =
      marked === null || start === null ? start : nextCell(start, direction, elites.keys(), shape);
    setHovered(null);
    if (next !== null) onMark(next);
  };
  const open = (event: MouseEvent) => {
    const cell = filledCellAt(event);
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
        onPointerMove={(event) => setHovered(filledCellAt(event))}
        onPointerLeave={() => setHovered(null)}
        onClick={open}
        onKeyDown={press}
      >
        <canvas ref={canvas} />
      </div>
      <Horizontal axis={axes[0]} />
      <Legend label={words(colourBy)} range={range} whole={colourBy === "generation"} />
      <Reading elite={looked === null ? undefined : elites.get(looked)} axes={axes} />
    </div>
  );
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

function best(elites: Elites): number | null {
  const ranked = [...elites].sort(([, a], [, b]) => b.fitness - a.fitness);
  return ranked[0]?.[0] ?? null;
}
