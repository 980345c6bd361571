/** The results of a run as a sortable table. */

import { Fragment } from "preact";
import type { ResultRow, Value } from "../../api/types";
import { short } from "../../ui/format";
import { Heading, type SortOrder } from "../../ui/Table";
import { type Column, type Order, columnsOf, sortRows } from "./columns";
import { text } from "./text";

/** The column of warnings. */
const NOTE = "warnings";

interface Props {
  rows: ResultRow[];
  order: Order;
  onOrder: (order: Order) => void;
  hrefOf: (creature: string) => string;
}

export function ResultTable({ rows, order, onOrder, hrefOf }: Props) {
  const columns = columnsOf(rows);
  // Warnings have a line of their own; a single form is named above the plot.
  const shown = columns.filter(({ name }) => name !== NOTE && (name !== "form" || several(rows, name)));
  const watchable = rows.some((row) => row.creature !== null);
  return (
    <div class="scroll">
      <table class="results">
        <thead>
          <tr>
            {watchable && <th scope="col">{text.replay}</th>}
            {shown.map((column) => (
              <Heading
                key={column.name}
                {...column}
                order={orderOf(column.name, order)}
                onSort={() => onOrder({ by: column.name, down: order.by === column.name && !order.down })}
              />
            ))}
          </tr>
        </thead>
        <tbody>
          {sortRows(rows, order).map((row, i) => (
            <Fragment key={row.creature ?? i}>
              <tr class={rowClass(row)}>
                {watchable && (
                  <td>
                    {row.creature && (
                      <a href={hrefOf(row.creature)}>
                        <code>{short(row.creature)}</code>
                      </a>
                    )}
                  </td>
                )}
                {shown.map((column) => (
                  <td key={column.name} class={column.numeric ? "numeric" : ""}>
                    <Cell column={column} value={row[column.name] ?? null} />
                  </td>
                ))}
              </tr>
              {row[NOTE] && (
                <tr class="note">
                  <td colSpan={shown.length + Number(watchable)}>
                    <span class="warning-text">{row[NOTE]}</span>
                  </td>
                </tr>
              )}
            </Fragment>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function orderOf(name: string, { by, down }: Order): SortOrder {
  if (by !== name) return "none";
  return down ? "descending" : "ascending";
}

function several(rows: ResultRow[], name: string): boolean {
  return new Set(rows.map((row) => row[name])).size > 1;
}

function Cell({ column, value }: { column: Column; value: Value }) {
  const written = column.write(value);
  const mark = markOf(column.name, value);
  return mark ? <span class={`mark-word ${mark}`}>{written}</span> : <>{written}</>;
}

/** The kind of highlight of a value. */
function markOf(name: string, value: Value): "wrong" | "warned" | null {
  if (name === "status" && value !== "ok") return "wrong";
  const doubtful = (name === "force_free" && value === false) || (name === "limited" && Number(value) > 0);
  return doubtful ? "warned" : null;
}

function rowClass({ status, [NOTE]: note }: ResultRow): string {
  return `${status !== undefined && status !== "ok" ? "failed" : ""} ${note ? "noted" : ""}`;
}
