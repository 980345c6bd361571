/** Curves over the generations, the evaluations or the time of a run. */

import { useEffect, useMemo, useRef } from "preact/hooks";
import uPlot from "uplot";
import { useSize, useTheme } from "../../ui/canvas";
import { type CurveView, type Axis, tableOf } from "./curveView";
import { type Band, type Plot, type Series, newest, valueAt } from "./plots";
import { text } from "./text";
import { Term } from "../../ui/Term";
import "uplot/dist/uPlot.min.css";
import "../lineStyle.css";
import "./curves.css";
import { count, number } from "../../ui/format";
import { ticksOf } from "../plot/scale";

interface Props {
  plots: Plot[];
  view: CurveView;
  /** Places on the x axis with a vertical line. */
  marks?: readonly number[];
}

export function Curves({ plots, view, marks = NO_MARKS }: Props) {
  return (
    <div class="curves">
      {plots.map((plot) => (
        <Curve key={plot.title} {...{ plot, view, marks }} />
      ))}
    </div>
  );
}

const NONE: readonly Band[] = [];
const NO_MARKS: readonly number[] = [];

interface CurveProps extends Required<Omit<Props, "plots">> {
  plot: Plot;
}

function Curve({ plot, view, marks }: CurveProps) {
  const { title, format, series } = plot;
  const { over, log } = view;
  const host = useChart({ plot, view, marks });
  const lines = series.filter(({ faint, edge }) => !faint && !edge);
  const now = lines.map(({ name, y }) => [...(lines.length > 1 ? [name] : []), format(newest(y))]);
  const label = text.label(title, text.over[over], now.map((each) => each.join(" ")).join(", "));
  return (
    <figure class="curve">
      <figcaption class="quiet small">
        <span>
          <Term name={title} />
        </span>
        <NewestValues series={lines} format={format} />
      </figcaption>
      <div ref={host} class="plot" role="img" aria-label={label} />
      {!series.some(({ y }) => y.some((value) => value !== null && (!log || value > 0))) && (
        <p class="quiet small">{log ? text.noneAboveZero : text.noValues}</p>
      )}
    </figure>
  );
}

/** Keep a chart in the returned element. */
function useChart({ plot: { format, series, bands = NONE }, view: { over, log }, marks }: CurveProps) {
  const host = useRef<HTMLDivElement>(null);
  const chart = useRef<uPlot | null>(null);
  const { width, height } = useSize(host);
  const theme = useTheme();
  const drawn = width > 0;
  const style = series
    .map(({ name, colour, dots, dash, faint, edge }) => [name, colour, dots, dash, faint, edge].join(" "))
    .join();
  const table = useMemo(() => tableOf(series, log), [log, ...series.flatMap(columnsOf)]);
  const changed = [drawn, theme, style, over, log, format, marks.join()];

  useEffect(() => {
    if (!drawn) return;
    const ink = colourResolver(host.current!);
    const options = optionsOf({ series, bands, marks, format, over, log, ink });
    chart.current = new uPlot(options, [[], ...series.map(() => [])], host.current!);
    return () => chart.current?.destroy();
  }, changed);

  useEffect(() => {
    if (drawn) chart.current?.setSize({ width, height });
  }, [width, height, ...changed]);

  useEffect(() => {
    chart.current?.setData(table);
  }, [table, ...changed]);
  return host;
}

/** Resolve a CSS variable to a colour for a canvas, with an opacity in percent. */
const colourResolver =
  (element: HTMLElement) =>
  (variable: string, opacity = 100) => {
    element.style.color = `color-mix(in srgb, var(${variable}) ${opacity}%, transparent)`;
    const { color } = getComputedStyle(element);
    element.style.color = "";
    return color;
  };

/** The columns that a table of curves depends on. */
const columnsOf = ({ x, y }: Series) => [x, y];

/** The newest values of a run; the legend above the plots names other runs. */
function NewestValues({ series, format }: { series: Series[]; format: Plot["format"] }) {
  if (series.every(({ other }) => other)) return null;
  const several = series.filter(({ other }) => !other).length > 1;
  return (
    <span class="curve-keys">
      {series.map(({ name, about, colour, dots, other, y }) => (
        <span key={name} class="curve-key" title={about ?? name}>
          {series.length > 1 && (
            <>
              <i class={dots ? "dot" : ""} style={{ background: `var(${colour})` }} />{" "}
              {!other && several && `${name} `}
            </>
          )}
          <b>{format(newest(y))}</b>
        </span>
      ))}
    </span>
  );
}

/** Steps between ticks of integers. */
const WHOLE = Array.from({ length: 13 }, (_, power) => [1, 2, 5].map((k) => k * 10 ** power)).flat();
const SYNC = "generations";

type Ink = (variable: string, opacity?: number) => string;

interface Drawing {
  series: Series[];
  bands: readonly Band[];
  marks: readonly number[];
  format: Plot["format"];
  over: Axis;
  log: boolean;
  ink: Ink;
}

function optionsOf({ series, bands, marks, format, over, log, ink }: Drawing): uPlot.Options {
  const axis: uPlot.Axis = {
    stroke: ink("--quiet"),
    grid: { stroke: ink("--line"), width: 1 },
    ticks: { show: false },
    font: "11px system-ui, sans-serif",
  };
  const named = over === "generation" ? {} : { values: formatTicks((value) => number(value)) };
  return {
    width: 1, // The size of the element follows.
    height: 1,
    legend: { show: false },
    cursor: { sync: { key: SYNC }, y: false, drag: { x: false, y: false } },
    scales: {
      x: { time: false },
      y: log ? { distr: 3, range: aroundPositive } : { range: fromZero },
    },
    axes: [
      { ...axis, size: 24, gap: 4, ...named, ...(over !== "seconds" && { incrs: WHOLE }) },
      { ...axis, size: 52, gap: 6, values: formatTicks(format), ...(log && LOG_TICKS) },
    ],
    series: [{}, ...series.map((each) => styleOf(each, ink, series.length === 1 && !log))],
    bands: bands.map(({ high, low, colour }) => ({
      series: [high + 1, low + 1],
      fill: ink(colour, 17),
    })),
    plugins: [tooltip(series, format, over), verticals(marks, ink("--accent"))],
  };
}

const formatTicks =
  (format: (value: number) => string): uPlot.Axis.DynamicValues =>
  (_, values) =>
    values.map(format);

/** Round ticks, all labelled; those of uPlot start at the end of the scale. */
const LOG_TICKS: Pick<uPlot.Axis, "splits" | "filter"> = {
  splits: (_plot, _axis, low, high) => ticksOf({ log: true, low, high }, 5),
  filter: (_plot, ticks) => ticks,
};

function styleOf(series: Series, ink: Ink, alone: boolean): uPlot.Series {
  const { name, colour, dots, dash, faint, edge } = series;
  const stroke = ink(colour);
  const base: uPlot.Series = { label: name, stroke, width: 1.75 };
  if (dots) return { ...base, paths: () => null, points: { show: true, size: 7, fill: stroke } };
  if (edge) return { ...base, stroke: ink(colour, 40), width: 0.75, points: { show: false } };
  if (faint) return { ...base, width: 1, alpha: 0.35, points: { show: false } };
  const lonely = (plot: uPlot) => plot.data[0].length === 1;
  const fill = alone && { fill: ink(colour, 12) };
  return { ...base, ...(dash && { dash }), points: { show: lonely }, ...fill };
}

/** From zero, so that curves can be compared. */
function fromZero(_: uPlot, low: number | null, high: number | null): [number, number] {
  return [Math.min(0, low ?? 0), Math.max(0, high ?? 1) * 1.06 || 1];
}

/** Room for positive values, at least half a decade. */
function aroundPositive(_: uPlot, low: number | null, high: number | null): [number, number] {
  const [from, to] = [low ?? 1, high ?? 10];
  const beside = Math.max(1.1, Math.sqrt(3 / (to / from)));
  return [from / beside, to * beside];
}

/** A tooltip with the values under the pointer, synchronised between plots. */
function tooltip(series: Series[], format: Plot["format"], over: Axis): uPlot.Plugin {
  const box = document.createElement("div");
  box.className = "curve-tip";
  return {
    hooks: {
      init: (plot) => void plot.over.append(box),
      setCursor: (plot) => {
        const { idx, left = -1 } = plot.cursor;
        const values = idx == null ? [] : valuesAt(plot, series, format, idx);
        box.hidden = values.length === 0 || left < 0;
        if (values.length === 0) return;
        const between = values.length > 2 ? "\n" : ", ";
        box.textContent = `${xText(plot.data[0][idx!]!, over)}: ${values.join(between)}`;
        box.classList.toggle("flip", left > plot.over.clientWidth / 2);
        box.style.left = `${left}px`;
      },
    },
  };
}

/** Dashed vertical lines at places of the x axis. */
const verticals = (places: readonly number[], stroke: string): uPlot.Plugin => ({
  hooks: {
    drawAxes: ({ ctx, bbox: { top, height }, valToPos }) => {
      ctx.save();
      Object.assign(ctx, { strokeStyle: stroke, lineWidth: devicePixelRatio });
      ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
      ctx.beginPath();
      for (const place of places) {
        const x = Math.round(valToPos(place, "x", true));
        ctx.moveTo(x, top);
        ctx.lineTo(x, top + height);
      }
      ctx.stroke();
      ctx.restore();
    },
  },
});

function valuesAt(plot: uPlot, series: Series[], format: Plot["format"], idx: number): string[] {
  return series.flatMap(({ name, faint, dots, edge }, i) => {
    const column = plot.data[i + 1] as (number | null | undefined)[];
    if (faint || edge || column[idx] === null) return [];
    // Between two points a line has the earlier value.
    const value = dots
      ? column[idx]
      : valueAt(
          column.map((each) => each ?? null),
          idx,
        );
    if (value == null) return [];
    return [series.length > 1 ? `${name} ${format(value)}` : format(value)];
  });
}

const xText = (at: number, over: Axis) =>
  over === "seconds" ? `${number(at)} s` : over === "evaluations" ? count(at) : String(at);
