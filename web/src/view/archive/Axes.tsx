/** The axes of the map, labelled with raw values. */

import type { Axis } from "../../api/types";
import { number, scientific, words } from "../format";
import { type Tick, ticks } from "./geometry";

export function Horizontal({ axis }: { axis: Axis }) {
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

export function Vertical({ axis }: { axis: Axis }) {
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

function label(axis: Axis, { value }: Tick): string {
  const plain = axis.scale === "linear" || (value >= 1e-2 && value < 1e4);
  return plain ? number(value) : scientific(value, 0);
}

function name(axis: Axis): string {
  return words(axis.name) + (axis.scale === "log10" ? " (log)" : "");
}
