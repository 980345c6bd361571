/** Measures of the focused elite. */

import { count, number, shortId } from "../ui/format";
import { FITNESS } from "./axes";
import type { ArchiveViewProps } from "./binFocus";
import { AGE } from "./colouring";
import type { Tile } from "./projection";
import { text } from "./text";

interface Props extends ArchiveViewProps {
  tile: Tile | undefined;
  /** Shown without a focused elite. */
  hint: string;
}

export function EliteMeasures({ tile, hint, ...props }: Props) {
  return (
    <p id="elite-measures" class="elite-measures" aria-live="polite">
      {tile ? <Figures {...props} {...tile} /> : <span class="quiet">{hint}</span>}
    </p>
  );
}

function Figures({ elite, cell, hidden, ...props }: ArchiveViewProps & Tile) {
  const { axes, colouring, projection, onOpen, actions } = props;
  const isBest = projection.tiles.get(projection.bins.get(cell)!)?.cell === cell;
  const measures = new Map([...axes, colouring.measure].map((measure) => [measure.name, measure]));
  for (const name of [FITNESS, AGE]) measures.delete(name);
  const figures = [
    [text.fitness, number(elite.fitness)],
    ...[...measures.values()].map(({ title, valueOf }) => [title, number(valueOf(elite))]),
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
          {isBest ? text.bestOf : text.oneOf} <b>{count(hidden + 1)}</b> {text.here}
        </span>
      )}
      <button class="link" onClick={() => onOpen(cell)}>
        {text.open} <code>{shortId(elite.creature)}</code>
      </button>
      {actions(elite, cell)}
    </>
  );
}
