/** Wall time and memory against the number of nodes, part by part. */

import type { ResultRow, Spec, Values } from "../../api/types";
import { bytes, count, number } from "../../ui/format";
import type { Axis, Line } from "../../charts/plot/Plot";
import { logAround } from "../../charts/plot/scale";
import { text } from "./text";

interface Part {
  name: string;
  method: string;
  column: string;
  colour: string;
  dash?: string;
  width?: number;
}

const [OURS, PAIRS] = [text.allParts, text.allPairs];

const PARTS: Part[] = [
  { name: OURS, method: "microcosmos", column: "seconds", colour: "--series-1", width: 2.6 },
  { name: "fluid", method: "microcosmos", column: "fluid", colour: "--series-2" },
  { name: "coupling", method: "microcosmos", column: "coupling", colour: "--series-3" },
  { name: "constraints", method: "microcosmos", column: "constraints", colour: "--series-4" },
  { name: "steric", method: "microcosmos", column: "steric", colour: "--series-5" },
  {
    name: PAIRS,
    method: "all-pairs",
    column: "seconds",
    colour: "--quiet",
    dash: "6 5",
  },
];
const MEMORY: Part = {
  name: "memory",
  method: "microcosmos",
  column: "memory_bytes",
  colour: "--series-1",
  width: 2.4,
};

const positive = (value: unknown): value is number => typeof value === "number" && value > 0;

export function timeLines(rows: readonly ResultRow[], summary: Values | null): Line[] {
  const power = (name: string) => {
    const value = summary?.[name];
    return typeof value === "number" ? value : null;
  };
  const powers: Record<string, number | null> = {
    [OURS]: power("exponent"),
    [PAIRS]: power("exponent_all_pairs"),
  };
  const lines = PARTS.map((part) => ({
    ...lineOf(part, rows, (value) => text.secondsFor(number(value))),
    power: powers[part.name] ?? null,
  }));
  return lines.filter(({ points }) => points.length > 0);
}

export function memoryLines(rows: readonly ResultRow[]): Line[] {
  return [lineOf(MEMORY, rows, bytes)];
}

function lineOf(part: Part, rows: readonly ResultRow[], write: (value: number) => string): Line {
  const { column, method, ...look } = part;
  const mine = rows.filter((row) => row.method === method && positive(row[column]));
  const points = mine.map((row) => ({
    x: Number(row.nodes),
    y: Number(row[column]),
    says: [part.name, text.nodesOf(count(Number(row.nodes))), write(Number(row[column]))] as [
      string,
      ...string[],
    ],
  }));
  return { ...look, points: points.sort((a, b) => a.x - b.x) };
}

export function nodesAxis(spec: Spec): Axis {
  const nodes = Array.isArray(spec.nodes) ? spec.nodes.map(Number) : [];
  return { title: text.nodes, scale: logAround(nodes), write: thousands };
}

export function logAxis(title: string, lines: Line[], write: (value: number) => string): Axis {
  const values = lines.flatMap(({ points }) => points.map(({ y }) => y ?? 0));
  return { title, scale: logAround(values), write };
}

function thousands(value: number): string {
  if (value >= 1e6) return `${number(value / 1e6)} M`;
  return value >= 1e3 ? `${number(value / 1e3)} k` : number(value);
}
