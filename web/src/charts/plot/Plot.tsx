/** Lines with marked points over two axes; marks can be links. */

import { useEffect, useRef, useState } from "preact/hooks";
import { useSize } from "../../ui/canvas";
import { type PlotArea, type TopAxis, AxisTitles, Frame } from "./Frame";
import { type Scale, positionOf } from "./scale";
import "../lineStyle.css";
import "./plot.css";
import { text } from "../curves/text";

export interface Point {
  x: number;
  /** Null without a value: the point is a cross at the top. */
  y: number | null;
  hollow?: boolean;
  href?: string;
  /** Tooltip: a name, then figures. */
  tooltip: [name: string, ...figures: string[]];
}

export interface Line {
  name: string;
  colour: string;
  dash?: string;
  width?: number;
  /** The exponent of its power law in x. */
  power?: number | null;
  points: Point[];
}

export interface Axis {
  title: string;
  scale: Scale;
  format: (value: number) => string;
}

export interface PlotProps {
  title: string;
  x: Axis;
  y: Axis;
  lines: Line[];
  topAxis?: TopAxis | null;
  shaded?: boolean;
  /** Called with the mark under the pointer or with the focus. */
  onFocusPoint?: (point: Point | null) => void;
}

export function Plot({ title, x, y, lines, topAxis = null, shaded = false, onFocusPoint }: PlotProps) {
  const host = useRef<HTMLDivElement>(null);
  const { width, height } = useSize(host);
  const [hovered, setHovered] = useState<string | null>(null);
  const [focused, setFocused] = useState<Point | null>(null);
  useEffect(() => onFocusPoint?.(focused), [focused]);
  const area: PlotArea = { left: 78, right: width - 14, top: topAxis ? 48 : 14, bottom: height - 48 };
  const drawn = lines.map((line, k) => ({ line, pixels: line.points.map((p) => pixelOf(p, k, x, y, area)) }));
  const highlighted = hovered ?? lines.find(({ points }) => points.includes(focused!))?.name ?? null;
  const faint = ({ name }: Line) => (highlighted !== null && highlighted !== name ? "faint" : "");
  const follow = (event: PointerEvent) => {
    const box = host.current!.getBoundingClientRect();
    setFocused(nearest(drawn, event.clientX - box.left, event.clientY - box.top));
  };
  return (
    <figure class="xy">
      {lines.length > 1 && <Legend lines={lines} of={x.title} onHover={setHovered} />}
      <div
        ref={host}
        class="xy-plot"
        role="group"
        aria-label={title}
        onPointerMove={follow}
        onPointerDown={follow}
        onPointerLeave={() => setFocused(null)}
      >
        {width > 0 && (
          <svg width={width} height={height} aria-hidden="true">
            <Frame {...{ x, y, area, topAxis, shaded }} />
            {drawn.map(({ line, pixels }) => (
              <path key={line.name} class={`xy-line ${faint(line)}`} {...pathOf(line, pixels)} />
            ))}
          </svg>
        )}
        {width > 0 && <AxisTitles {...{ x, y, area, topAxis }} />}
        {width > 0 &&
          drawn.flatMap(({ line, pixels }) =>
            line.points.map((point, i) => (
              <Mark
                key={`${line.name} ${point.x}`}
                {...{ point, line, position: pixels[i]!, width, onFocusPoint: setFocused }}
                state={point === focused ? "near" : faint(line)}
              />
            )),
          )}
      </div>
    </figure>
  );
}

const strokeOf = ({ colour, dash, width }: Line) => ({
  stroke: `var(${colour})`,
  strokeDasharray: dash,
  strokeWidth: width,
});

/** The position of a point; crosses are at the top, one row per line. */
function pixelOf(point: Point, k: number, x: Axis, y: Axis, area: PlotArea): [number, number] {
  const { left, right, top, bottom } = area;
  return [
    left + positionOf(x.scale, point.x) * (right - left),
    point.y === null ? top + 10 + 12 * k : bottom - positionOf(y.scale, point.y) * (bottom - top),
  ];
}

interface Drawn {
  line: Line;
  pixels: [number, number][];
}

/** Maximal distance of the pointer from a point, in pixels. */
const MAX_DISTANCE = 22;

/** The point nearest to the pointer. */
function nearest(drawn: Drawn[], x: number, y: number): Point | null {
  let [best, least]: [Point | null, number] = [null, MAX_DISTANCE];
  for (const { line, pixels } of drawn) {
    pixels.forEach(([left, top], i) => {
      const distance = Math.hypot(left - x, top - y);
      if (distance < least) [best, least] = [line.points[i]!, distance];
    });
  }
  return best;
}

/** The path through the points with a value. */
function pathOf(line: Line, pixels: Drawn["pixels"]) {
  const known = pixels.filter((_, i) => line.points[i]!.y !== null);
  const d = known.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
  return { d, style: strokeOf(line) };
}

interface LegendProps {
  lines: Line[];
  of: string;
  onHover: (name: string | null) => void;
}

function Legend({ lines, of, onHover }: LegendProps) {
  return (
    <figcaption class="row small xy-legend">
      {lines.map((line) => (
        <span key={line.name} onPointerEnter={() => onHover(line.name)} onPointerLeave={() => onHover(null)}>
          <svg viewBox="0 0 26 10" aria-hidden="true">
            <path d="M1 5h24" style={strokeOf({ ...line, width: 2.2 })} />
          </svg>
          {line.name}
          {line.power != null && (
            <span class="quiet">
              ∝ {of.toLowerCase()}
              <sup>{line.power.toFixed(2)}</sup>
            </span>
          )}
        </span>
      ))}
    </figcaption>
  );
}

interface MarkProps {
  point: Point;
  line: Line;
  position: [number, number];
  state: string;
  /** The width of the plot: in its right half the tooltip is to the left. */
  width: number;
  onFocusPoint: (point: Point | null) => void;
}

/** A point of a plot with its tooltip; a link if it has a replay. */
function Mark({ point, line, position, state, width, onFocusPoint }: MarkProps) {
  const [name, ...figures] = point.tooltip;
  const kind = point.y === null ? "cross" : point.hollow ? "hollow" : "";
  const common = {
    class: `mark ${kind} ${state}`,
    style: { left: `${position[0]}px`, top: `${position[1]}px`, "--colour": `var(${line.colour})` },
    "aria-label": [name, ...figures].join(", "),
    onFocus: () => onFocusPoint(point),
    onBlur: () => onFocusPoint(null),
  };
  const tip = (
    <span class={`tip ${position[0] > width / 2 ? "flip" : ""}`} aria-hidden="true">
      <b>{name}</b>
      {figures.map((figure) => (
        <span key={figure}>{figure}</span>
      ))}
      {point.href && <i>{text.clickToWatch}</i>}
    </span>
  );
  if (!point.href) return <span role="img" tabIndex={0} {...common} children={tip} />;
  return <a href={point.href} {...common} children={tip} />;
}
