/** What pages of runs share whose result is a table. */

import type { ResultRow, Results, Run } from "../../api/types";
import { resultsUrl } from "../../api/urls";
import { useResults } from "../../store/fetch";
import { setQuery } from "../../store/router";
import { ResultTable } from "./ResultTable";
import type { Order } from "./columns";
import { text } from "./text";
import "./results.css";

export interface ResultsProps {
  run: Run;
  query: URLSearchParams;
}

interface Shown {
  results: Results | null;
  /** What to say while there is nothing to show. */
  missing: string | null;
}

const EMPTY: Record<Run["status"], string> = {
  queued: text.queued,
  running: text.running,
  paused: text.paused,
  finished: text.noResults,
  failed: text.failed,
  cancelled: text.cancelled,
};

export function useTable(run: Run): Shown {
  const { value, error } = useResults(run.id);
  // What was fetched stays while fetching it anew fails.
  if (value && value.rows.length > 0) return { results: value, missing: null };
  return { results: value, missing: error ?? (value ? EMPTY[run.status] : text.loading) };
}

export const hrefOf = (run: Run) => (creature: string) => `/creatures/${creature}?run=${run.id}`;

export function TableCard({ run, query, rows }: ResultsProps & { rows: ResultRow[] }) {
  const order: Order = { by: query.get("sort"), down: query.get("order") === "down" };
  const turn = ({ by, down }: Order) => setQuery({ sort: by, order: down ? "down" : null });
  return (
    <section class="card table-card" aria-labelledby="table-title">
      <div class="card-head">
        <h2 id="table-title">{text.table}</h2>
        <span class="quiet">{text.rows(rows.length)}</span>
        <span class="spring" />
        <a class="button" href={resultsUrl(run.id)}>
          {text.download}
        </a>
      </div>
      <ResultTable rows={rows} order={order} onOrder={turn} hrefOf={hrefOf(run)} />
    </section>
  );
}
