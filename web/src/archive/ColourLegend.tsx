/** The colour legend of the map. */

import { ColourBar } from "../ui/ColourBar";
import { css, sequential } from "../ui/colours";
import { count, number } from "../ui/format";
import { valueAt } from "../charts/plot/scale";
import { type Colouring, AGE } from "./colouring";
import { text } from "./text";

export function ColourLegend({ colouring }: { colouring: Colouring }) {
  const { measure, palette, scale } = colouring;
  const format = measure.name === AGE ? count : number;
  const numbers = [0, 0.5, 1].map((t) => format(valueAt(scale, t)));
  const label = measure.unit ? `${measure.title} (${measure.unit})` : measure.title;
  return (
    <ColourBar
      name={label}
      label={text.legend(label, numbers[0], numbers[2])}
      colourAt={(share) => css(sequential(share, palette))}
      numbers={numbers}
    />
  );
}
