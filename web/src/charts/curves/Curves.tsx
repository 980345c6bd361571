/** Curves over the generations, the evaluations or the time of a run. */

import { useEffect, useMemo, useRef } from "preact/hooks";
import uPlot from "uplot";
import { useSize, useTheme } from "../../ui/canvas";
import { type CurveView, tableOf } from "./curveView";
import { optionsOf } from "./options";
import { type Band, type Plot, type Series, newest } from "./plots";
import { text } from "./text";
import { Term } from "../../ui/Term";
import "uplot/dist/uPlot.min.css";
import "../lineStyle.css";
import "./curves.css";

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
