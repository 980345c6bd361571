/** The elites of the marked bin, to step through a front or another bin of a pool. */

import { number } from "../ui/format";
import { FITNESS, type Measure } from "./axes";
import type { ArchiveViewProps } from "./binFocus";
import { elitesIn } from "./projection";
import { text } from "./text";

interface Props extends ArchiveViewProps {
  /** The second objective of fronts; fitness if there is none. */
  objective: Measure;
}

export function BinElites({ lists, projection, marked, onMark, objective }: Props) {
  const bin = marked === null ? undefined : projection.bins.get(marked);
  if (!lists || bin === undefined) return null;
  const elites = elitesIn(projection, bin);
  if (elites.length < 2) return null;
  return (
    <section class="bin-elites" aria-label={text.binElites}>
      <ol>
        {elites.map(([cell, elite]) => (
          <li key={cell}>
            <button class="plain" aria-pressed={cell === marked} onClick={() => onMark(cell)}>
              {text.fitness} <b>{number(elite.fitness)}</b>
              {objective.name !== FITNESS && (
                <>
                  {" "}
                  {objective.title} <b>{number(objective.valueOf(elite))}</b>
                </>
              )}
            </button>
          </li>
        ))}
      </ol>
    </section>
  );
}
