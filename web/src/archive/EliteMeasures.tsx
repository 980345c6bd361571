/** Measures of the focused elite. */

import type { ComponentChildren } from "preact";
import type { Elite } from "../store/elites";
import { count, number, shortId } from "../ui/format";
import { FITNESS, type MapAxis, type Measure } from "./axes";
import { AGE } from "./colouring";
import type { Tile } from "./projection";
import { text } from "./text";

interface Props {
  tile: Tile | undefined;
  axes: readonly MapAxis[];
  colour: Measure;
  /** Shown without a focused elite. */
  hint: string;
  onOpen: (cell: number) => void;
  /** Further links and buttons for an elite. */
  actions: (elite: Elite, cell: number) => ComponentChildren;
}

export function EliteMeasures({ tile, axes, colour, hint, onOpen, actions }: Props) {
  return (
    <p id="elite-measures" class="elite-measures" aria-live="polite">
      {tile ? (
        <Figures {...{ tile, onOpen, actions }} measures={[...axes, colour]} />
      ) : (
        <span class="quiet">{hint}</span>
      )}
    </p>
  );
}

interface FiguresProps extends Pick<Props, "onOpen" | "actions"> {
  tile: Tile;
  measures: readonly Measure[];
}

function Figures({ tile: { elite, cell, hidden }, measures, onOpen, actions }: FiguresProps) {
  const shown = new Map(measures.map((measure) => [measure.name, measure]));
  for (const name of [FITNESS, AGE]) shown.delete(name);
  const figures = [
    [text.fitness, number(elite.fitness)],
    ...[...shown.values()].map(({ title, valueOf }) => [title, number(valueOf(elite))]),
    [text.generation, elite.generation],
  ];
  return (
    <>
      {figures.map(([title, value]) => (
        <span key={title}>
          {title} <b>{value}</b>
        </span>
      ))}
      {hidden > 0 && (
        <span>
          {text.bestOf} <b>{count(hidden + 1)}</b> {text.here}
        </span>
      )}
      <button class="link" onClick={() => onOpen(cell)}>
        {text.open} <code>{shortId(elite.creature)}</code>
      </button>
      {actions(elite, cell)}
    </>
  );
}
