/** Lines and dots over the generations. */

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { useSize } from "../canvas";
import { useTheme } from "../theme";
import { type Plot, type Series, newest } from "./plots";

/** Steps between ticks of generations, which are whole. */
const WHOLE = [1, 10, 100, 1e3, 1e4, 1e5, 1e6].flatMap((power) => [power, 2 * power, 5 * power]);
const SYNC = "generations";

interface Props {
  plots: Plot[];
  generation: readonly number[];
}

export function Curves({ plots, generation }: Props) {
  return (
    <div class="curves">
      {plots.map((plot) => (
        <Curve key={plot.title} plot={plot} x={generation} />
      ))}
    </div>
  );
}

function Curve({ plot: { title, write, series }, x }: { plot: Plot; x: readonly number[] }) {
  const host = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const { width, height } = useSize(host);
  const theme = useTheme();
  const drawn = width > 0;
  const looks = series.map(({ name, colour, dots }) => `${name} ${colour} ${dots}`).join();

  useEffect(() => {
    if (!drawn) return;
    const style = getComputedStyle(host.current!);
    const ink = (name: string) => style.getPropertyValue(name).trim();
    const options = optionsOf(series, write, ink);
    plot.current = new uPlot(options, [[], ...series.map(() => [])], host.current!);
    return () => plot.current?.destroy();
  }, [drawn, theme, looks, write]);

  useEffect(() => {
    if (drawn) plot.current?.setSize({ width, height });
  }, [drawn, width, height, theme, looks]);

  useEffect(() => {
    plot.current?.setData([x as number[], ...series.map(({ y }) => y as (number | null)[])]);
  }, [x, ...series.map(({ y }) => y), drawn, theme, looks]);

  const words = series.map(({ name, y }) => [name, write(newest(y))] as const);
  const now = words.length === 1 ? words[0]![1] : words.map((each) => each.join(" ")).join(", ");
  return (
    <figure class="curve">
      <figcaption>
        <span>{title}</span>
        <span class="curve-keys">
          {series.map(({ name, colour, dots }, i) => (
            <span key={name} class="curve-key">
              {series.length > 1 && (
                <>
                  <i class={dots ? "dot" : ""} style={{ background: `var(${colour})` }} /> {name}{" "}
                </>
              )}
              <b>{words[i]![1]}</b>
            </span>
          ))}
        </span>
      </figcaption>
      <div ref={host} class="plot" role="img" aria-label={`${title} over generations: now ${now}`} />
    </figure>
  );
}

function optionsOf(
  series: Series[],
  write: Plot["write"],
  ink: (name: string) => string,
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
    series: [{}, ...series.map((each) => lookOf(each, ink, series.length === 1))],
    plugins: [tooltip(series, write)],
  };
}

function lookOf({ name, colour, dots }: Series, ink: (name: string) => string, alone: boolean) {
  const stroke = ink(colour);
  const look: uPlot.Series = { label: name, stroke, width: 1.75, spanGaps: true };
  if (dots) return { ...look, paths: () => null, points: { show: true, size: 7, fill: stroke } };
  const lonely = (plot: uPlot) => plot.data[0].length === 1;
  return { ...look, points: { show: lonely }, ...(alone && { fill: `${stroke}1f` }) };
}

/** From zero, so that curves can be compared by eye. */
function fromZero(_: uPlot, low: number | null, high: number | null): [number, number] {
  return [Math.min(0, low ?? 0), Math.max(0, high ?? 1) * 1.06 || 1];
}

/** The values under the pointer, and under the pointer's place on the other plots. */
function tooltip(series: Series[], write: Plot["write"]): uPlot.Plugin {
  const box = document.createElement("div");
  box.className = "curve-tip";
  return {
    hooks: {
      init: (plot) => void plot.over.append(box),
      setCursor: (plot) => {
        const { idx, left = -1 } = plot.cursor;
        const values = series.map((_, i) => (idx == null ? null : plot.data[i + 1]![idx]));
        const told = values.flatMap((value, i) => {
          if (value == null) return [];
          return [series.length > 1 ? `${series[i]!.name} ${write(value)}` : write(value)];
        });
        box.hidden = told.length === 0 || left < 0;
        if (told.length === 0) return;
        box.textContent = `${plot.data[0][idx!]}: ${told.join(", ")}`;
        box.classList.toggle("flip", left > plot.over.clientWidth / 2);
        box.style.left = `${left}px`;
      },
    },
  };
}
