/** Results of a scaling run: wall time and memory against the number of nodes. */

import type { ResultRow, Values } from "../../api/types";
import { Plot, type Axis, type Line, type Point } from "../../charts/plot/Plot";
import { logAround } from "../../charts/plot/scale";
import { Card } from "../../ui/Page";
import { bytes, number, count } from "../../ui/format";
import { type ResultsProps, TableCard, useResultsTable } from "../results/ResultsTable";
import { text } from "./text";

export function ScalingRun({ run, query }: ResultsProps) {
  const { results, missing } = useResultsTable(run);
  if (missing || !results) {
    return (
      <section class="card">
        <p class="quiet waiting">{missing}</p>
      </section>
    );
  }
  const { rows, summary } = results;
  const times = timeLines(rows, summary);
  const memory = [lineOf(MEMORY, rows, bytes)];
  const nodes = (run.spec.nodes as number[]) ?? [];
  const x = { title: text.nodes, scale: logAround(nodes), format: thousands };
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
  { name: PAIRS, method: "all-pairs", column: "seconds", colour: "--quiet", dash: "6 5" },
];
const MEMORY: Part = { ...PARTS[0]!, name: "memory", column: "memory_bytes", width: 2.4 };

const positive = (value: unknown): value is number => typeof value === "number" && value > 0;

export function timeLines(rows: readonly ResultRow[], summary: Values | null): Line[] {
  const { exponent = null, exponent_all_pairs = null } = summary ?? {};
  const powers = { [OURS]: exponent, [PAIRS]: exponent_all_pairs } as Record<string, number | null>;
  const format = (value: number) => text.secondsFor(number(value));
  const lines = PARTS.map((part) => ({ ...lineOf(part, rows, format), power: powers[part.name] ?? null }));
  return lines.filter(({ points }) => points.length > 0);
}

function lineOf(part: Part, rows: readonly ResultRow[], format: (value: number) => string): Line {
  const { column, method, ...view } = part;
  const measured = rows.filter((row) => row.method === method && positive(row[column]));
  const points = measured.map((row): Point => {
    const [x, y] = [Number(row.nodes), Number(row[column])];
    return { x, y, tooltip: [part.name, text.nodesOf(count(x)), format(y)] };
  });
  return { ...view, points: points.sort((a, b) => a.x - b.x) };
}

function logAxis(title: string, lines: Line[], format: (value: number) => string): Axis {
  const values = lines.flatMap(({ points }) => points.map(({ y }) => y ?? 0));
  return { title, scale: logAround(values), format };
}

function thousands(value: number): string {
  if (value >= 1e6) return `${number(value / 1e6)} M`;
  return value >= 1e3 ? `${number(value / 1e3)} k` : number(value);
}
