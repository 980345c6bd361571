/** A heat map over time (across) and space (up), with a cursor at the time of the replay. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { ColourBar } from "../ui/ColourBar";
import { css, diverging, lut } from "../ui/colours";
import type { Playhead } from "../replay/clock";
import { useTheme } from "../ui/canvas";
import { text } from "./text";

interface Matrix {
  columns: number;
  rows: number;
  /** (column, row); the first row is drawn lowest. */
  values: ArrayLike<number>;
}

interface Props {
  matrix: Matrix;
  /** The absolute value at both ends of the colour map. */
  limit: number;
  label: string;
  /** Text below while no cell is pointed at. */
  about?: string;
  /** Text for the cell under the pointer or the arrow keys. */
  read: (column: number, row: number) => string;
  playhead: Playhead;
  /** The horizontal position of a time, from 0 to 1; and the inverse, if a click can choose a time. */
  positionOf: (time: number) => number;
  timeAt?: (position: number) => number;
}

interface HeatCell {
  column: number;
  row: number;
}

export function HeatMap({ matrix, limit, label, about, read, playhead, positionOf, timeAt }: Props) {
  const { columns, rows } = matrix;
  const box = useRef<HTMLDivElement>(null);
  const [cell, setCell] = useState<HeatCell | null>(null);
  const pointAt = (event: PointerEvent) => {
    const { left, top, width, height } = box.current!.getBoundingClientRect();
    const across = Math.min(1, Math.max(0, (event.clientX - left) / width));
    const up = Math.min(1, Math.max(0, 1 - (event.clientY - top) / height));
    setCell({ column: indexAt(across, columns), row: indexAt(up, rows) });
    if (timeAt && event.buttons === 1) playhead.scrub(timeAt(across));
  };
  const now = () => indexAt(positionOf(playhead.time), columns);
  const moveByKey = (event: KeyboardEvent) => {
    const next = nextCell(event.key, cell, now(), matrix);
    if (!next) return;
    event.preventDefault();
    setCell(next);
    if (timeAt && next.column !== now()) playhead.scrub(timeAt((next.column + 0.5) / columns));
  };
  return (
    <div class="heat">
      <div
        ref={box}
        class="heat-picture"
        tabIndex={0}
        role="application"
        aria-label={text.heatMap(label)}
        onPointerMove={pointAt}
        onPointerDown={pointAt}
        onPointerLeave={() => setCell(null)}
        onKeyDown={moveByKey}
        onBlur={() => setCell(null)}
      >
        <Picture {...{ matrix, limit }} />
        {cell && <span class="heat-spot" style={cellStyle(cell, matrix)} />}
        <Cursor {...{ playhead, positionOf }} />
      </div>
      <p class="heat-reading small" aria-live="polite">
        {cell ? read(cell.column, cell.row) : about}
      </p>
    </div>
  );
}

/** The cell after an arrow key, from the one that is read or from the current column. */
export function nextCell(
  key: string,
  cell: HeatCell | null,
  now: number,
  { columns, rows }: Pick<Matrix, "columns" | "rows">,
): HeatCell | null {
  const within = (value: number, count: number) => Math.min(count - 1, Math.max(0, value));
  const { column, row } = cell ?? { column: now, row: null };
  if (key === "ArrowLeft" || key === "ArrowRight") {
    const by = key === "ArrowLeft" ? -1 : 1;
    return { column: within(column + by, columns), row: row ?? 0 };
  }
  if (key === "ArrowUp") return { column, row: within((row ?? -1) + 1, rows) };
  if (key === "ArrowDown") return { column, row: within((row ?? rows) - 1, rows) };
  return null;
}

const indexAt = (share: number, count: number) => Math.min(count - 1, Math.floor(share * count));

function cellStyle({ column, row }: HeatCell, { columns, rows }: Matrix) {
  const share = (value: number) => `${100 * value}%`;
  return { left: share((column + 0.5) / columns), bottom: share((row + 0.5) / rows) };
}

function Picture({ matrix: { columns, rows, values }, limit }: Pick<Props, "matrix" | "limit">) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const colours = useMemo(() => lut((t) => diverging(t, theme), 255, [-1, 1]), [theme]);
  useEffect(() => {
    const image = new ImageData(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    for (let column = 0; column < columns; column++) {
      for (let row = 0; row < rows; row++) {
        const t = Math.min(1, Math.max(-1, values[column * rows + row]! / (limit || 1)));
        pixels[(rows - 1 - row) * columns + column] = colours[Math.round(127 * t) + 127]!;
      }
    }
    canvas.current!.getContext("2d")!.putImageData(image, 0, 0);
  }, [columns, rows, values, limit, colours]);
  return <canvas ref={canvas} width={columns} height={rows} aria-hidden="true" />;
}

/** A cursor that moves without rendering anything else. */
function Cursor({ playhead, positionOf }: Pick<Props, "playhead" | "positionOf">) {
  const line = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    const move = () => {
      // The clock may tick once more after the page was left.
      line.current?.style.setProperty("left", `${100 * positionOf(playhead.time)}%`);
    };
    move();
    return playhead.listen(move);
  }, [playhead, positionOf]);
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
