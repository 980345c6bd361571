/** Which runs are compared, and how each of them is drawn. */

import type { Run } from "../../api/types";
import { setQuery } from "../../router";
import { Badge } from "../../view/RunBits";

export interface Compared {
  run: Run;
  name: string;
  /** Which of the series' colours, from 0; later ones are dashed too. */
  place: number;
}

const DASHED = 4;

export const colourOf = (place: number) => `--series-${1 + (place % 8)}`;
export const dashOf = (place: number) => (place >= DASHED ? [7, 4] : undefined);

export function Legend({ runs, ids }: { runs: Compared[]; ids: string[] }) {
  const without = (id: string) => ids.filter((each) => each !== id).join() || null;
  return (
    <ul class="compare-legend" aria-label="Runs">
      {runs.map(({ run, name, place }) => (
        <li key={run.id}>
          <Key place={place} />
          <a href={`/runs/${run.id}`}>{name}</a>
          <Badge run={run} />
          <button
            class="plain small-button"
            aria-label={`Leave ${name} out`}
            onClick={() => setQuery({ runs: without(run.id) })}
          >
            ✕
          </button>
        </li>
      ))}
    </ul>
  );
}

export function Key({ place }: { place: number }) {
  const strokeDasharray = dashOf(place)?.join(" ");
  return (
    <svg class="compare-key" viewBox="0 0 26 10" aria-hidden="true">
      <path d="M1 5h24" style={{ stroke: `var(${colourOf(place)})`, strokeDasharray }} />
    </svg>
  );
}
