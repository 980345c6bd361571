/** What the columns of results mean, with their units, and how their values are written. */

import type { ResultRow, Value } from "../../api/types";
import { formOf } from "../../ui/coupling";
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
  form: { write: (value) => formOf(String(value)).title },
  viscosity: { unit: "cells²/step" },
  displacement: { unit: "cells/cycle" },
  direction: { unit: "rad" },
  reynolds: { title: "Reynolds" },
  sperm: { title: "Sperm" },
  mach: { title: "Mach" },
  limited: { title: text.limited, unit: text.ofNodeSteps, write: as(percent) },
  impulse: { title: text.impulse, unit: text.latticeUnits, write: as((x) => number(x, 2)) },
  force_free: { title: text.forceFree },
  nodes: { write: as(count) },
  steps: { title: text.stepsTimed, write: as(count) },
  seconds: { title: text.all, ...seconds },
  fluid: seconds,
  coupling: seconds,
  constraints: seconds,
  steric: seconds,
  first: { title: text.firstLoss },
  last: { title: text.lastLoss },
  least: { title: text.leastLoss },
  empty: { title: text.emptyLoss },
  failed: { title: text.failedUpdates, write: as(count) },
  slope: { title: text.slope },
  agreement: { title: text.gain },
  memory_bytes: { title: text.memory, write: as(bytes) },
};

/** The columns of some rows, in their order; the creature is none of them. */
export function columnsOf(rows: readonly ResultRow[]): Column[] {
  const names = [...new Set(rows.flatMap(Object.keys))].filter((name) => name !== "creature");
  return names.map((name) => ({
    name,
    title: words(name),
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

/** Rows in order of a column; those without a value come last, equal ones stay as they are. */
export function sortRows(rows: readonly ResultRow[], { by, down }: Order): ResultRow[] {
  if (by === null) return [...rows];
  return [...rows].sort((a, b) => {
    const [one, two] = [a[by] ?? null, b[by] ?? null];
    if (one === null || two === null) return Number(one === null) - Number(two === null);
    const way = typeof one === "string" ? one.localeCompare(String(two)) : Number(one) - Number(two);
    return down ? -way : way;
  });
}
