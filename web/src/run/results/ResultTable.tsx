/** The results of a run as a sortable table. */

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
                order={orderOf(column.name, order)}
                onSort={() => onOrder({ by: column.name, down: order.by === column.name && !order.down })}
              />
            ))}
          </tr>
        </thead>
        <tbody>
          {sortRows(rows, order).map((row, i) => (
            <Row key={row.creature ?? i} {...{ row, columns, linked, hrefOf }} />
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

interface RowProps {
  row: ResultRow;
  columns: Column[];
  /** True if the rows have creatures. */
  linked: boolean;
  hrefOf: (creature: string) => string;
}

function Row({ row, columns, linked, hrefOf }: RowProps) {
  const { creature, status, [NOTE]: note } = row;
  const failed = status !== undefined && status !== "ok";
  return (
    <>
      <tr class={`${failed ? "failed" : ""} ${note ? "noted" : ""}`}>
        {linked && (
          <td>
            {creature && (
              <a href={hrefOf(creature)}>
                <code>{short(creature)}</code>
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
