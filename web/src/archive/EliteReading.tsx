/** Measures of the elite under the pointer. */

import type { ComponentChildren } from "preact";
import type { Elite } from "../store/elites";
import { count, number, short } from "../ui/format";
import { FITNESS, type MapAxis, type Measure } from "./axes";
import { AGE } from "./colouring";
import type { Tile } from "./projection";
import { text } from "./text";

interface Props {
  tile: Tile | undefined;
  axes: readonly MapAxis[];
  colour: Measure;
  /** Shown if no elite is pointed at. */
  hint: string;
  onOpen: (cell: number) => void;
  /** What else can be done with an elite. */
  actions: (elite: Elite, cell: number) => ComponentChildren;
}

export function EliteReading({ tile, axes, colour, hint, onOpen, actions }: Props) {
  return (
    <p id="map-reading" class="map-reading" aria-live="polite">
      {tile ? (
        <Words {...{ tile, onOpen, actions, measures: [...axes, colour] }} />
      ) : (
        <span class="quiet">{hint}</span>
      )}
    </p>
  );
}

interface WordsProps {
  tile: Tile;
  measures: readonly Measure[];
  onOpen: (cell: number) => void;
  actions: Props["actions"];
}

function Words({ tile: { elite, cell, behind }, measures, onOpen, actions }: WordsProps) {
  const told = new Map(measures.map((measure) => [measure.name, measure]));
  for (const name of [FITNESS, AGE]) told.delete(name);
  return (
    <>
      <span>
        {text.fitness} <b>{number(elite.fitness)}</b>
      </span>
      {[...told.values()].map(({ name, title, valueOf }) => (
        <span key={name}>
          {title} <b>{number(valueOf(elite))}</b>
        </span>
      ))}
      <span>
        {text.generation} <b>{elite.generation}</b>
      </span>
      {behind > 0 && (
        <span>
          {text.bestOf} <b>{count(behind + 1)}</b> {text.here}
        </span>
      )}
      <button class="link" onClick={() => onOpen(cell)}>
        {text.open} <code>{short(elite.creature)}</code>
      </button>
      {actions(elite, cell)}
    </>
  );
}
