/** The legend of the compared runs. */

import type { Run } from "../api/types";
import { LineKey } from "../charts/lineStyle";
import { setQuery } from "../store/router";
import { StatusBadge } from "../run/RunStatus";
import { text } from "./text";

export interface Compared {
  run: Run;
  name: string;
  /** Which of the series' colours, from 0; later ones are dashed too. */
  place: number;
}

export function Legend({ runs, ids }: { runs: Compared[]; ids: string[] }) {
  const without = (id: string) => ids.filter((each) => each !== id).join() || null;
  return (
    <ul class="compare-legend" aria-label={text.runs}>
      {runs.map(({ run, name, place }) => (
        <li key={run.id}>
          <LineKey index={place} />
          <a href={`/runs/${run.id}`}>{name}</a>
          <StatusBadge run={run} />
          <button
            class="plain small-button"
            aria-label={text.remove(name)}
            onClick={() => setQuery({ runs: without(run.id) })}
          >
            ✕
          </button>
        </li>
      ))}
    </ul>
  );
}
