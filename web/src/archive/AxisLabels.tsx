/** The axes of the map, labelled with raw values. */

import { positionOf, ticksOf } from "../charts/plot/scale";
import { number, scientific } from "../ui/format";
import { type MapAxis, scaleOf } from "./axes";

const MAX_TICKS = 6;

export function AxisLabels({ axis, side }: { axis: MapAxis; side: "x" | "y" }) {
  const scale = scaleOf(axis);
  const start = side === "x" ? "left" : "bottom";
  return (
    <div class={`axis axis-${side}`} aria-hidden="true">
      {ticksOf(scale, MAX_TICKS).map((value) => (
        <span key={value} class="tick" style={{ [start]: `${100 * positionOf(scale, value)}%` }}>
          {!scale.log || (value >= 1e-2 && value < 1e4) ? number(value) : scientific(value, 0)}
        </span>
      ))}
      <span class="axis-name">{name(axis)}</span>
    </div>
  );
}

function name({ title, unit, scale }: MapAxis): string {
  const beside = [unit, scale === "log10" ? "log" : ""].filter(Boolean).join(", ");
  return title + (beside && ` (${beside})`);
}
