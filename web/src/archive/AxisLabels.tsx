/** The axes of the map, labelled with raw values. */

import { number, scientific } from "../ui/format";
import type { MapAxis } from "./axes";
import { type Tick, ticks } from "./geometry";

export function HorizontalLabels({ axis }: { axis: MapAxis }) {
  return (
    <div class="axis axis-x" aria-hidden="true">
      {ticks(axis).map((tick) => (
        <span key={tick.at} class="tick" style={{ left: `${100 * tick.at}%` }}>
          {label(axis, tick)}
        </span>
      ))}
      <span class="axis-name">{name(axis)}</span>
    </div>
  );
}

export function VerticalLabels({ axis }: { axis: MapAxis }) {
  return (
    <div class="axis axis-y" aria-hidden="true">
      {ticks(axis).map((tick) => (
        <span key={tick.at} class="tick" style={{ bottom: `${100 * tick.at}%` }}>
          {label(axis, tick)}
        </span>
      ))}
      <span class="axis-name">{name(axis)}</span>
    </div>
  );
}

function label(axis: MapAxis, { value }: Tick): string {
  const plain = axis.scale === "linear" || (value >= 1e-2 && value < 1e4);
  return plain ? number(value) : scientific(value, 0);
}

function name({ title, unit, scale }: MapAxis): string {
  const beside = [unit, scale === "log10" ? "log" : ""].filter(Boolean).join(", ");
  return title + (beside && ` (${beside})`);
}
