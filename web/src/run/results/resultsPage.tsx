/** The table of results of a run, and its states before there are rows. */

import type { ResultRow, Results, Run } from "../../api/types";
import { resultsUrl } from "../../api/urls";
import { useResults } from "../../store/fetch";
import { setQuery } from "../../store/router";
import { Card } from "../../ui/Page";
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
  /** A note while there are no rows. */
  missing: string | null;
}

export function useTable(run: Run): Shown {
  const { value, error } = useResults(run.id);
  // The last rows stay while fetching them again fails.
  if (value && value.rows.length > 0) return { results: value, missing: null };
  return { results: value, missing: error ?? (value ? text.missing[run.status] : text.loading) };
}

export const hrefOf = (run: Run) => (creature: string) => `/creatures/${creature}?run=${run.id}`;

export function TableCard({ run, query, rows }: ResultsProps & { rows: ResultRow[] }) {
  const order: Order = { by: query.get("sort"), down: query.get("order") === "down" };
  const turn = ({ by, down }: Order) => setQuery({ sort: by, order: down ? "down" : null });
  const download = (
    <a class="button" href={resultsUrl(run.id)}>
      {text.download}
    </a>
  );
  return (
    <Card id="table" kind="table-card" title={text.table} note={text.rows(rows.length)} actions={download}>
      <ResultTable rows={rows} order={order} onOrder={turn} hrefOf={hrefOf(run)} />
    </Card>
  );
}
