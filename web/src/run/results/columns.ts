/** The columns of results: titles, units and formats. */

import type { ResultRow, Value } from "../../api/types";
import { couplingForm } from "../../ui/coupling";
import { DASH, bytes, count, number, percent, words } from "../../ui/format";
import { text } from "./text";

export interface Column {
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

export interface Order {
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
