/** Tables of the figures of runs and of the differences of their specs. */

import { useMemo } from "preact/hooks";
import type { Run } from "../api/types";
import { DASH, count, duration, number } from "../ui/format";
import { timeOf } from "../run/RunStatus";
import { SCORES } from "../run/figures";
import { differences, written } from "../run/spec/difference";
import { LineKey } from "../charts/lineStyle";
import { Card } from "../ui/Page";
import { Table } from "../ui/Table";
import { Term } from "../ui/Term";
import { text } from "./text";

export interface Compared {
  run: Run;
  name: string;
  /** Index of the line's colour and dash. */
  place: number;
}

type Written = [title: string, write: (run: Run) => string];

const FIGURES: Written[] = [
  ...SCORES.map(([name, title, write]): Written => [title, (run) => write(run[name], 5)]),
  [text.generations, (run) => `${count(run.generation)} / ${count(run.generations)}`],
  [text.evaluations, (run) => count(run.evaluations)],
  [text.diverged, (run) => count(run.diverged)],
  [text.evaluationsPerSecond, (run) => number(run.evaluations_per_second)],
  [text.time, (run) => (run.eta_seconds ? text.left(duration(run.eta_seconds)) : timeOf(run).text)],
  [text.device, (run) => run.device ?? DASH],
];

export function Figures({ runs }: { runs: Compared[] }) {
  const rows = FIGURES.map(([title, write]) => ({ title, values: runs.map(({ run }) => write(run)) }));
  return (
    <Card id="figures" title={text.figures}>
      <RunTable runs={runs} corner={text.figure} rows={rows} />
    </Card>
  );
}

export function Specs({ runs }: { runs: Compared[] }) {
  const specs = runs.map(({ run }) => run.spec);
  const differing = useMemo(() => differences(specs), specs);
  const rows = differing.map(({ path, values }) => ({ title: path, values: values.map(written) }));
  return (
    <Card id="specs" title={text.differences}>
      {rows.length === 0 && <p class="quiet">{text.noDifferences}</p>}
      {rows.length > 0 && <RunTable runs={runs} corner={text.field} rows={rows} code />}
    </Card>
  );
}

interface RunTableProps {
  runs: Compared[];
  corner: string;
  rows: { title: string; values: string[] }[];
  /** True if the titles are paths of the spec. */
  code?: boolean;
}

function RunTable({ runs, corner, rows, code = false }: RunTableProps) {
  const columns = runs.map(({ name, place }, i) => ({
    title: (
      <>
        <LineKey index={place} /> {name}
      </>
    ),
    cell: ({ values }: (typeof rows)[0]) => values[i]!,
  }));
  const first = {
    title: corner,
    cell: ({ title }: (typeof rows)[0]) => (code ? <code>{title}</code> : <Term name={title} />),
  };
  return (
    <Table
      label={text.tableOf(corner)}
      columns={[first, ...columns]}
      rows={rows}
      keyOf={({ title }) => title}
    />
  );
}
