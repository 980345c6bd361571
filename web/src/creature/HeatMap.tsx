/** A heat map over time (across) and space (up), with a cursor at a moment. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { ColourBar } from "../ui/ColourBar";
import { css, diverging, table } from "../ui/colours";
import type { Moment } from "../replay/moment";
import { useTheme } from "../ui/canvas";
import { text } from "./text";

export interface Cells {
  columns: number;
  rows: number;
  /** (column, row); the first row is drawn lowest. */
  values: ArrayLike<number>;
}

interface Props {
  cells: Cells;
  /** The absolute value at both ends of the colour map. */
  most: number;
  label: string;
  /** Text below while no cell is pointed at. */
  about?: string;
  /** Text for the cell under the pointer or the arrow keys. */
  read: (column: number, row: number) => string;
  moment: Moment;
  /** The horizontal position of a moment, from 0 to 1; and the inverse, if a click can choose one. */
  positionOf: (time: number) => number;
  timeAt?: (position: number) => number;
}

export interface Spot {
  column: number;
  row: number;
}

export function HeatMap({ cells, most, label, about, read, moment, positionOf, timeAt }: Props) {
  const { columns, rows } = cells;
  const box = useRef<HTMLDivElement>(null);
  const [spot, setSpot] = useState<Spot | null>(null);
  const at = (event: PointerEvent) => {
    const { left, top, width, height } = box.current!.getBoundingClientRect();
    const across = Math.min(1, Math.max(0, (event.clientX - left) / width));
    const up = Math.min(1, Math.max(0, 1 - (event.clientY - top) / height));
    setSpot({ column: cellOf(across, columns), row: cellOf(up, rows) });
    if (timeAt && event.buttons === 1) moment.scrub(timeAt(across));
  };
  const now = () => cellOf(positionOf(moment.time), columns);
  const walk = (event: KeyboardEvent) => {
    const next = moveSpot(event.key, spot, now(), cells);
    if (!next) return;
    event.preventDefault();
    setSpot(next);
    if (timeAt && next.column !== now()) moment.scrub(timeAt((next.column + 0.5) / columns));
  };
  return (
    <div class="heat">
      <div
        ref={box}
        class="heat-picture"
        tabIndex={0}
        role="application"
        aria-label={text.heatMap(label)}
        onPointerMove={at}
        onPointerDown={at}
        onPointerLeave={() => setSpot(null)}
        onKeyDown={walk}
        onBlur={() => setSpot(null)}
      >
        <Picture {...{ cells, most }} />
        {spot && <span class="heat-spot" style={spotStyle(spot, cells)} />}
        <Cursor {...{ moment, positionOf }} />
      </div>
      <p class="heat-reading small" aria-live="polite">
        {spot ? read(spot.column, spot.row) : about}
      </p>
    </div>
  );
}

/** The cell after an arrow key, from the one that is read or from the current column. */
export function moveSpot(
  key: string,
  spot: Spot | null,
  now: number,
  { columns, rows }: Pick<Cells, "columns" | "rows">,
): Spot | null {
  const within = (value: number, count: number) => Math.min(count - 1, Math.max(0, value));
  const { column, row } = spot ?? { column: now, row: null };
  if (key === "ArrowLeft" || key === "ArrowRight") {
    const by = key === "ArrowLeft" ? -1 : 1;
    return { column: within(column + by, columns), row: row ?? 0 };
  }
  if (key === "ArrowUp") return { column, row: within((row ?? -1) + 1, rows) };
  if (key === "ArrowDown") return { column, row: within((row ?? rows) - 1, rows) };
  return null;
}

const cellOf = (share: number, count: number) => Math.min(count - 1, Math.floor(share * count));

function spotStyle({ column, row }: Spot, { columns, rows }: Cells) {
  const share = (value: number) => `${100 * value}%`;
  return { left: share((column + 0.5) / columns), bottom: share((row + 0.5) / rows) };
}

function Picture({ cells: { columns, rows, values }, most }: Pick<Props, "cells" | "most">) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const colours = useMemo(() => table((t) => diverging(t, theme), 255, [-1, 1]), [theme]);
  useEffect(() => {
    const image = new ImageData(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    for (let column = 0; column < columns; column++) {
      for (let row = 0; row < rows; row++) {
        const t = Math.min(1, Math.max(-1, values[column * rows + row]! / (most || 1)));
        pixels[(rows - 1 - row) * columns + column] = colours[Math.round(127 * t) + 127]!;
      }
    }
    canvas.current!.getContext("2d")!.putImageData(image, 0, 0);
  }, [columns, rows, values, most, colours]);
  return <canvas ref={canvas} width={columns} height={rows} aria-hidden="true" />;
}

/** A cursor that moves without rendering anything else. */
function Cursor({ moment, positionOf }: Pick<Props, "moment" | "positionOf">) {
  const line = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    const move = () => {
      // The clock may tick once more after the page was left.
      line.current?.style.setProperty("left", `${100 * positionOf(moment.time)}%`);
    };
    move();
    return moment.listen(move);
  }, [moment, positionOf]);
  return <span ref={line} class="heat-cursor" />;
}

export function DivergingLegend({ title, end }: { title: string; end: string }) {
  const theme = useTheme();
  return (
    <ColourBar
      name={title}
      label={text.divergingLegend(title, end)}
      colourAt={(share) => css(diverging(2 * share - 1, theme))}
      numbers={[`−${end}`, "0", end]}
    />
  );
}
