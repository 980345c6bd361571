/** A table with a column for each thing that is compared. */

import type { ComponentChildren } from "preact";
import { Table } from "../ui/Table";
import { Term } from "../ui/Term";

export interface Row {
  title: string;
  values: string[];
}

interface Props {
  label: string;
  corner: string;
  columns: readonly ComponentChildren[];
  rows: readonly Row[];
  /** True if the titles are paths of the spec. */
  code?: boolean;
}

export function ComparisonTable({ label, corner, columns, rows, code = false }: Props) {
  const first = {
    title: corner,
    cell: ({ title }: Row) => (code ? <code>{title}</code> : <Term name={title} />),
  };
  const others = columns.map((title, i) => ({ title, cell: ({ values }: Row) => values[i]! }));
  return <Table columns={[first, ...others]} keyOf={({ title }) => title} {...{ label, rows }} />;
}
