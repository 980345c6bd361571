/** Sweeps above the list of runs, one row for each. */

import type { SweepPage } from "../api/types";
import { dateTime } from "../ui/format";
import { SweepProgress, SweepStates, sizeText, sweepTitle } from "../sweeps/SweepStatus";
import { text } from "./text";

interface Props {
  page: SweepPage;
  /** Null if all are shown. */
  onMore: (() => void) | null;
}

export function SweepRows({ page, onMore }: Props) {
  return (
    <section class="sweep-rows" aria-label={text.sweeps}>
      <ul>
        {page.items.map((sweep) => (
          <li key={sweep.id} class="card sweep-row">
            <span class="sweep-name">
              <a class="run-name" href={`/sweeps/${sweep.id}`}>
                {sweepTitle(sweep)}
              </a>
              <span class="quiet small">
                {sizeText(sweep)} · {dateTime(sweep.created_at)}
              </span>
            </span>
            <span class="sweep-status">
              <SweepProgress sweep={sweep} />
              <SweepStates sweep={sweep} />
            </span>
            <a class="button" href={`/?sweep=${sweep.id}`} aria-label={text.runsOfSweep(sweepTitle(sweep))}>
              {text.runs}
            </a>
          </li>
        ))}
      </ul>
      {page.next && onMore && <button onClick={onMore}>{text.moreSweeps}</button>}
    </section>
  );
}
