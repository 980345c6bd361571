/** The sortable table of results of a run, and its states before there are rows. */

import type { ResultRow, Run, Value } from "../../api/types";
import { resultsUrl } from "../../api/files";
import { useResults } from "../../store/fetch";
import { setQuery } from "../../store/router";
import { Card } from "../../ui/Page";
import { Heading } from "../../ui/Table";
import { shortId, DASH, bytes, count, number, percent, words } from "../../ui/format";
import { text } from "./text";
import "./results.css";
import { couplingForm } from "../../ui/coupling";

export interface ResultsProps {
  run: Run;
  query: URLSearchParams;
}

/** The results of a run; `missing` is a note while there are no rows. */
export function useResultsTable(run: Run) {
  const { value, error } = useResults(run.id);
  // The last rows stay while fetching them again fails.
  if (value && value.rows.length > 0) return { results: value, missing: null };
  return { results: value, missing: error ?? (value ? text.missing[run.status] : text.loading) };
}

export const hrefOf = (run: Run) => (creature: string) => `/creatures/${creature}?run=${run.id}`;

export function TableCard({ run, query, rows }: ResultsProps & { rows: ResultRow[] }) {
  const order: Order = { by: query.get("sort"), down: query.get("order") === "down" };
  const download = (
    <a class="button" href={resultsUrl(run.id)}>
      {text.download}
    </a>
  );
  return (
    <Card id="table" kind="table-card" title={text.table} note={text.rows(rows.length)} actions={download}>
      <ResultTable {...{ run, rows, order }} />
    </Card>
  );
}

/** The column of warnings. */
const NOTE = "warnings";

function ResultTable({ run, rows, order }: { run: Run; rows: ResultRow[]; order: Order }) {
  const sort = ({ by, down }: Order) => setQuery({ sort: by, order: down ? "down" : null });
  // Warnings have a line of their own; a single form is named above the plot.
  const columns = columnsOf(rows).filter(
    ({ name }) => name !== NOTE && (name !== "form" || new Set(rows.map(({ form }) => form)).size > 1),
  );
  const linked = rows.some((row) => row.creature !== null);
  return (
    <div class="scroll">
      <table class="results">
        <thead>
          <tr>
            {linked && <th scope="col">{text.replay}</th>}
            {columns.map((column) => (
              <Heading
                key={column.name}
                {...column}
                order={order.by !== column.name ? "none" : order.down ? "descending" : "ascending"}
                onSort={() => sort({ by: column.name, down: order.by === column.name && !order.down })}
              />
            ))}
          </tr>
        </thead>
        <tbody>
          {sortRows(rows, order).map((row, i) => (
            <Row key={row.creature ?? i} {...{ run, row, columns, linked }} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

interface RowProps {
  run: Run;
  row: ResultRow;
  columns: Column[];
  /** True if the rows have creatures. */
  linked: boolean;
}

function Row({ run, row, columns, linked }: RowProps) {
  const { creature, status, [NOTE]: note } = row;
  const failed = status !== undefined && status !== "ok";
  return (
    <>
      <tr class={`${failed ? "failed" : ""} ${note ? "noted" : ""}`}>
        {linked && (
          <td>
            {creature && (
              <a href={hrefOf(run)(creature)}>
                <code>{shortId(creature)}</code>
              </a>
            )}
          </td>
        )}
        {columns.map(({ name, numeric, write }) => (
          <td key={name} class={numeric ? "numeric" : ""}>
            <span class={markOf(name, row[name] ?? null)}>{write(row[name] ?? null)}</span>
          </td>
        ))}
      </tr>
      {note && (
        <tr class="note">
          <td colSpan={columns.length + Number(linked)}>
            <span class="warning-text">{note}</span>
          </td>
        </tr>
      )}
    </>
  );
}

/** The classes of a value that is highlighted. */
function markOf(name: string, value: Value): string {
  if (name === "status" && value !== "ok") return "mark-word wrong";
  const doubtful = (name === "force_free" && value === false) || (name === "limited" && Number(value) > 0);
  return doubtful ? "mark-word warned" : "";
}

interface Column {
  name: string;
  title: string;
  unit: string;
  numeric: boolean;
  write: (value: Value) => string;
}

const plain = (value: Value): string => {
  if (value === null || value === "") return DASH;
  if (typeof value === "boolean") return value ? text.yes : text.no;
  return typeof value === "number" ? number(value) : value;
};
const as = (write: (value: number) => string) => (value: Value) =>
  typeof value === "number" ? write(value) : plain(value);
const seconds = { unit: "s / 1,000 steps" };

const KNOWN: Record<string, Partial<Column>> = {
  form: { write: (value) => couplingForm(String(value)).title },
  viscosity: { unit: "cells²/step" },
  displacement: { unit: "cells/cycle" },
  direction: { unit: "rad" },
  limited: { unit: text.ofNodeSteps, write: as(percent) },
  impulse: { unit: text.latticeUnits, write: as((x) => number(x, 2)) },
  nodes: { write: as(count) },
  steps: { write: as(count) },
  seconds,
  fluid: seconds,
  coupling: seconds,
  constraints: seconds,
  steric: seconds,
  failed: { write: as(count) },
  memory_bytes: { write: as(bytes) },
};

/** The columns of rows without the creature, in their order. */
export function columnsOf(rows: readonly ResultRow[]): Column[] {
  const names = [...new Set(rows.flatMap(Object.keys))].filter((name) => name !== "creature");
  return names.map((name) => ({
    name,
    title: (text.titles as Record<string, string>)[name] ?? words(name),
    unit: "",
    write: plain,
    numeric: rows.some((row) => typeof row[name] === "number"),
    ...KNOWN[name],
  }));
}

interface Order {
  by: string | null;
  down: boolean;
}

/** Rows sorted by a column; rows without a value come last, equal rows keep their order. */
export function sortRows(rows: readonly ResultRow[], { by, down }: Order): ResultRow[] {
  if (by === null) return [...rows];
  return [...rows].sort((a, b) => {
    const [one, two] = [a[by] ?? null, b[by] ?? null];
    if (one === null || two === null) return Number(one === null) - Number(two === null);
    const way = typeof one === "string" ? one.localeCompare(String(two)) : Number(one) - Number(two);
    return down ? -way : way;
  });
}
