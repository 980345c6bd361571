/** QD score, coverage and best fitness over the generations. */

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import type { Curves as Columns } from "../live/curves";
import { useSize } from "./canvas";
import { number, percent } from "./format";
import { useTheme } from "./theme";

const CURVES = [
  { name: "qd_score", title: "QD score", colour: "--curve-1", write: number },
  { name: "coverage", title: "Coverage", colour: "--curve-2", write: percent },
  { name: "best", title: "Best fitness", colour: "--curve-3", write: number },
] as const;

/** Steps between ticks of generations, which are whole. */
const WHOLE = [1, 10, 100, 1e3, 1e4, 1e5, 1e6].flatMap((power) => [power, 2 * power, 5 * power]);
const SYNC = "generations";

export function Curves({ curves }: { curves: Columns }) {
  return (
    <div class="curves">
      {CURVES.map((curve) => (
        <Curve key={curve.name} {...curve} x={curves.generation} y={curves[curve.name]} />
      ))}
    </div>
  );
}

type Props = (typeof CURVES)[number] & { x: readonly number[]; y: readonly (number | null)[] };

function Curve({ title, colour, write, x, y }: Props) {
  const host = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const { width, height } = useSize(host);
  const theme = useTheme();
  const drawn = width > 0;

  useEffect(() => {
    if (!drawn) return;
    const style = getComputedStyle(host.current!);
    const ink = (name: string) => style.getPropertyValue(name).trim();
    const options = optionsOf(title, write, ink, colour);
    plot.current = new uPlot(options, [[], []], host.current!);
    return () => plot.current?.destroy();
  }, [drawn, theme, title, write, colour]);

  useEffect(() => {
    if (drawn) plot.current?.setSize({ width, height });
  }, [drawn, width, height, theme]);

  useEffect(() => {
    plot.current?.setData([x as number[], y as (number | null)[]]);
  }, [x, y, drawn, theme]);

  const last = y.at(-1);
  const text = last === undefined ? "no value yet" : write(last);
  return (
    <figure class="curve">
      <figcaption>
        <span>{title}</span>
        <b>{text}</b>
      </figcaption>
      <div ref={host} class="plot" role="img" aria-label={`${title} over generations: now ${text}`} />
    </figure>
  );
}

function optionsOf(
  title: string,
  write: (value: number | null) => string,
  ink: (name: string) => string,
  colour: string,
): uPlot.Options {
  const axis: uPlot.Axis = {
    stroke: ink("--quiet"),
    grid: { stroke: ink("--line"), width: 1 },
    ticks: { show: false },
    font: "11px system-ui, sans-serif",
  };
  return {
    width: 1, // Both follow at once, from the element's own size.
    height: 1,
    legend: { show: false },
    cursor: { sync: { key: SYNC }, y: false, drag: { x: false, y: false } },
    scales: { x: { time: false }, y: { range: fromZero } },
    axes: [
      { ...axis, size: 24, gap: 4, incrs: WHOLE },
      { ...axis, size: 52, gap: 6, values: (_, values) => values.map((v) => write(v)) },
    ],
    series: [
      {},
      {
        label: title,
        stroke: ink(colour),
        fill: `${ink(colour)}1f`,
        width: 1.75,
        points: { show: (plot) => plot.data[0].length === 1 },
      },
    ],
    plugins: [tooltip(write)],
  };
}

/** From zero, so that curves can be compared by eye. */
function fromZero(_: uPlot, low: number | null, high: number | null): [number, number] {
  return [Math.min(0, low ?? 0), Math.max(0, high ?? 1) * 1.06 || 1];
}

/** The value under the pointer, and under the pointer's place on the other curves. */
function tooltip(write: (value: number | null) => string): uPlot.Plugin {
  const box = document.createElement("div");
  box.className = "curve-tip";
  return {
    hooks: {
      init: (plot) => void plot.over.append(box),
      setCursor: (plot) => {
        const { idx, left = -1 } = plot.cursor;
        const value = idx == null ? null : plot.data[1]![idx];
        box.hidden = value == null || left < 0;
        if (value == null) return;
        box.textContent = `${plot.data[0][idx!]}: ${write(value)}`;
        box.classList.toggle("flip", left > plot.over.clientWidth / 2);
        box.style.left = `${left}px`;
      },
    },
  };
}
