/** The axes of the map, labelled with raw values, and its colour legend. */

import { positionOf, ticksOf, valueAt } from "../charts/plot/scale";
import { ColourBar } from "../ui/ColourBar";
import { css, sequential } from "../ui/colours";
import { count, number, scientific } from "../ui/format";
import { Term } from "../ui/Term";
import { type MapAxis, scaleOf } from "./axes";
import { type Colouring, AGE } from "./colouring";
import { text } from "./text";

const MAX_TICKS = 6;

export function AxisLabels({ axis, side }: { axis: MapAxis; side: "x" | "y" }) {
  const scale = scaleOf(axis);
  const start = side === "x" ? "left" : "bottom";
  return (
    <div class={`axis axis-${side}`}>
      {ticksOf(scale, MAX_TICKS).map((value) => (
        <span
          key={value}
          class="tick"
          style={{ [start]: `${100 * positionOf(scale, value)}%` }}
          aria-hidden="true"
        >
          {!scale.log || (value >= 1e-2 && value < 1e4) ? number(value) : scientific(value, 0)}
        </span>
      ))}
      <span class="axis-name">
        <Term name={nameOf(axis)} />
      </span>
    </div>
  );
}

function nameOf({ title, unit, scale }: MapAxis): string {
  const additions = [unit, scale === "log10" ? "log" : ""].filter(Boolean).join(", ");
  return title + (additions && ` (${additions})`);
}

export function ColourLegend({ colouring: { measure, palette, scale } }: { colouring: Colouring }) {
  const format = measure.name === AGE ? count : number;
  const numbers = [0, 0.5, 1].map((t) => format(valueAt(scale, t)));
  const name = measure.unit ? `${measure.title} (${measure.unit})` : measure.title;
  return (
    <ColourBar
      name={name}
      label={text.legend(name, numbers[0], numbers[2])}
      colourAt={(share) => css(sequential(share, palette))}
      numbers={numbers}
    />
  );
}
