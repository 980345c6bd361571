/** The legend of a tree: colours of fitness, or shapes and colours of operators. */

import type { Phylogeny } from "../decode/phylogeny";
import { ColourBar } from "../ui/ColourBar";
import { type Theme } from "../ui/canvas";
import { number } from "../ui/format";
import { type Shades, type Shape, fitnessColour, operatorColour, shapeOf } from "./shades";
import { text } from "./text";

interface Props {
  tree: Phylogeny;
  shades: Shades;
  theme: Theme;
  collapsed: boolean;
}

export function TreeLegend({ tree, shades: { by, range }, theme, collapsed }: Props) {
  const numbers = [range[0], (range[0] + range[1]) / 2, range[1]].map((value) => number(value));
  return (
    <div class="tree-legend small">
      {by === "fitness" ? (
        <ColourBar
          name={text.fitness}
          label={text.legend(text.fitness, numbers[0]!, numbers[2]!)}
          colourAt={(share) => fitnessColour(share, theme)}
          numbers={numbers}
        />
      ) : (
        <ul class="row tree-operators" aria-label={text.operator}>
          {tree.operators.map((name, i) => (
            <li key={name} class="compact">
              <Dot shape={shapeOf(tree, i)} colour={operatorColour(tree, i, theme)} />
              {name}
            </li>
          ))}
        </ul>
      )}
      <p class="quiet row">
        <span>{text.legendEdge}</span>
        <span class="compact">
          <Dot shape="circle" colour="currentColor" />
          {text.legendElite}
        </span>
        <span class="compact">
          <Dot shape="circle" colour="currentColor" hollow />
          {text.legendLost}
        </span>
        {collapsed && <span>{text.legendCount}</span>}
      </p>
    </div>
  );
}

const PATHS: Record<Shape, string> = {
  circle: "M11 6A5 5 0 1 1 1 6A5 5 0 1 1 11 6z",
  square: "M1.5 1.5h9v9h-9z",
  diamond: "M6 0.5L11.5 6L6 11.5L0.5 6z",
  triangle: "M6 1L11.5 10.5H0.5z",
};

function Dot({ shape, colour, hollow = false }: { shape: Shape; colour: string; hollow?: boolean }) {
  return (
    <svg class="tree-dot" viewBox="0 0 12 12" aria-hidden="true">
      <path d={PATHS[shape]} fill={hollow ? "none" : colour} stroke={colour} stroke-width="1.4" />
    </svg>
  );
}
