/** A table that scrolls sideways if it is too wide, and headings that sort tables. */

import type { ComponentChildren } from "preact";
import { Term } from "./Term";

export interface Column<Row> {
  title: ComponentChildren;
  /** True if only screen readers need the title. */
  unseen?: boolean;
  cell: (row: Row) => ComponentChildren;
}

interface Props<Row> {
  label: string;
  /** The first column names the row. */
  columns: readonly Column<Row>[];
  rows: readonly Row[];
  keyOf: (row: Row) => string | number;
  kind?: string;
  rowKind?: (row: Row) => string;
}

export function Table<Row>({ label, columns, rows, keyOf, kind = "", rowKind }: Props<Row>) {
  return (
    <div class={`wide-table ${kind}`} tabIndex={0} role="region" aria-label={label}>
      <table>
        <thead>
          <tr>
            {columns.map(({ title, unseen }, i) => (
              <th key={i} scope="col">
                <span class={unseen ? "unseen" : ""}>
                  {typeof title === "string" && !unseen ? <Term name={title} /> : title}
                </span>
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={keyOf(row)} class={rowKind?.(row)}>
              {columns.map((column, k) => (
                <Cell key={k} {...column} row={row} first={k === 0} />
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** A cell; where rows are shown as cards its column is named above it. */
function Cell<Row>({ title, unseen, cell, row, first }: Column<Row> & { row: Row; first: boolean }) {
  if (first) return <th scope="row">{cell(row)}</th>;
  return <td data-label={typeof title === "string" && !unseen ? title : undefined}>{cell(row)}</td>;
}

export type SortOrder = "ascending" | "descending" | "none";

interface HeadingProps {
  title: string;
  unit?: string;
  numeric?: boolean;
  order?: SortOrder;
  /** Without it the column cannot be sorted by. */
  onSort?: () => void;
}

export function Heading({ title, unit, numeric = false, order, onSort }: HeadingProps) {
  return (
    <th scope="col" aria-sort={order} class={numeric ? "numeric" : ""}>
      <Term name={title}>
        {onSort && (
          <button type="button" class="sort" onClick={onSort}>
            {title}
          </button>
        )}
      </Term>
      {unit && <span class="unit">{unit}</span>}
    </th>
  );
}
