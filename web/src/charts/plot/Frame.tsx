/** Axes, grid and titles of a plot. */

import { Term } from "../../ui/Term";
import { px } from "../../ui/canvas";
import type { Axis } from "./Plot";
import { positionOf, ticksOf } from "./scale";
import "./plot.css";

export interface PlotArea {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** A second axis above, with labels at values of the first one. */
export interface TopAxis {
  title: string;
  ticks: { at: number; text: string }[];
}

interface Props {
  x: Axis;
  y: Axis;
  area: PlotArea;
  topAxis: TopAxis | null;
  shaded: boolean;
}

/** Pixels per label along each axis. */
const [X_SPACING, Y_SPACING] = [52, 44];

export function Frame({ x, y, area, topAxis, shaded }: Props) {
  const { left, right, top, bottom } = area;
  const across = (value: number) => left + positionOf(x.scale, value) * (right - left);
  const up = (value: number) => bottom - positionOf(y.scale, value) * (bottom - top);
  return (
    <g class="xy-frame">
      <rect x={left} y={top} width={right - left} height={bottom - top} class={shaded ? "shaded" : ""} />
      {ticksOf(y.scale, (bottom - top) / Y_SPACING).map((value) => (
        <g key={value}>
          <path d={`M${left} ${up(value)}H${right}`} />
          <text x={left - 8} y={up(value) + 4} class="end">
            {y.format(value)}
          </text>
        </g>
      ))}
      {ticksOf(x.scale, (right - left) / X_SPACING).map((value) => (
        <g key={value}>
          <path d={`M${across(value)} ${top}V${bottom}`} />
          <text x={across(value)} y={bottom + 18}>
            {x.format(value)}
          </text>
        </g>
      ))}
      <path class="base" d={`M${left} ${bottom}H${right}`} />
      {topAxis &&
        uncrowded(topAxis.ticks, across).map(({ at, text }) => (
          <g key={at}>
            <path class="base" d={`M${across(at)} ${top}v-4`} />
            <text x={across(at)} y={top - 9}>
              {text}
            </text>
          </g>
        ))}
    </g>
  );
}

/** Names of the axes, over the drawing: their definitions need elements that can have the focus. */
export function AxisTitles({ x, y, area, topAxis }: Omit<Props, "shaded">) {
  const { left, right, top, bottom } = area;
  const across = { left, width: right - left };
  return (
    <>
      {topAxis && (
        <span class="axis-title" style={px({ ...across, top: top - 46 })}>
          <Term name={topAxis.title} />
        </span>
      )}
      <span class="axis-title" style={px({ ...across, top: bottom + 26 })}>
        <Term name={x.title} />
      </span>
      <span class="axis-title upright" style={px({ top, height: bottom - top })}>
        <Term name={y.title} />
      </span>
    </>
  );
}

/** The ticks with enough room, from the last one down. */
function uncrowded(ticks: TopAxis["ticks"], across: (value: number) => number): TopAxis["ticks"] {
  return ticks.reduceRight<TopAxis["ticks"]>((labelled, tick) => {
    const crowded = labelled[0] && across(labelled[0].at) - across(tick.at) < X_SPACING;
    return crowded ? labelled : [tick, ...labelled];
  }, []);
}
