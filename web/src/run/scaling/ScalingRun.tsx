/** Results of a scaling run: wall time and memory against the number of nodes. */

import type { ResultRow, Spec, Values } from "../../api/types";
import { Plot, type Axis, type Line } from "../../charts/plot/Plot";
import { logAround } from "../../charts/plot/scale";
import { Card } from "../../ui/Page";
import { bytes, number, count } from "../../ui/format";
import { type ResultsProps, TableCard, useTable } from "../results/resultsPage";
import { text } from "./text";

export function ScalingRun({ run, query }: ResultsProps) {
  const { results, missing } = useTable(run);
  if (missing || !results) {
    return (
      <section class="card">
        <p class="quiet waiting">{missing}</p>
      </section>
    );
  }
  const { rows, summary } = results;
  const times = timeLines(rows, summary);
  const memory = memoryLines(rows);
  const x = nodesAxis(run.spec);
  return (
    <>
      <div class="run-columns">
        <Card id="time" kind="plot-card" title={text.wallTime}>
          <Plot
            title={text.wallTimePlot}
            x={x}
            y={logAxis(text.seconds, times, (value) => number(value, 2))}
            lines={times}
          />
        </Card>
        <Card id="memory" kind="plot-card" title={text.memory}>
          <Plot title={text.memoryPlot} x={x} y={logAxis(text.memory, memory, bytes)} lines={memory} />
        </Card>
      </div>
      <TableCard run={run} query={query} rows={rows} />
    </>
  );
}

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

function memoryLines(rows: readonly ResultRow[]): Line[] {
  return [lineOf(MEMORY, rows, bytes)];
}

function lineOf(part: Part, rows: readonly ResultRow[], format: (value: number) => string): Line {
  const { column, method, ...view } = part;
  const mine = rows.filter((row) => row.method === method && positive(row[column]));
  const points = mine.map((row) => ({
    x: Number(row.nodes),
    y: Number(row[column]),
    tooltip: [part.name, text.nodesOf(count(Number(row.nodes))), format(Number(row[column]))] as [
      string,
      ...string[],
    ],
  }));
  return { ...view, points: points.sort((a, b) => a.x - b.x) };
}

function nodesAxis(spec: Spec): Axis {
  const nodes = Array.isArray(spec.nodes) ? spec.nodes.map(Number) : [];
  return { title: text.nodes, scale: logAround(nodes), format: thousands };
}

function logAxis(title: string, lines: Line[], format: (value: number) => string): Axis {
  const values = lines.flatMap(({ points }) => points.map(({ y }) => y ?? 0));
  return { title, scale: logAround(values), format };
}

function thousands(value: number): string {
  if (value >= 1e6) return `${number(value / 1e6)} M`;
  return value >= 1e3 ? `${number(value / 1e3)} k` : number(value);
}
