/** The figures of several runs, and where their specs differ. */

import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import type { Run } from "../api/types";
import { count, duration, number, percent } from "../ui/format";
import { timeOf } from "../run/RunStatus";
import { differences, written } from "../run/spec/difference";
import { LineKey } from "../charts/lineStyle";
import type { Compared } from "./Legend";

const ROWS: [title: string, write: (run: Run) => string][] = [
  ["QD score", (run) => number(run.qd_score, 5)],
  ["Coverage", (run) => percent(run.coverage)],
  ["Best fitness", (run) => number(run.best, 5)],
  ["Generations", (run) => `${count(run.generation)} / ${count(run.generations)}`],
  ["Evaluations", (run) => count(run.evaluations)],
  ["Diverged", (run) => count(run.diverged)],
  ["Evaluations/s", (run) => number(run.evaluations_per_second)],
  ["Time", (run) => (run.eta_seconds ? `${duration(run.eta_seconds)} left` : timeOf(run).text)],
  ["Device", (run) => run.device ?? "–"],
];

export function Figures({ runs }: { runs: Compared[] }) {
  return (
    <section class="card" aria-labelledby="compare-figures">
      <h2 id="compare-figures">Figures</h2>
      <Table runs={runs} corner="Figure">
        {ROWS.map(([title, write]) => (
          <tr key={title}>
            <th scope="row">{title}</th>
            {runs.map(({ run }) => (
              <td key={run.id}>{write(run)}</td>
            ))}
          </tr>
        ))}
      </Table>
    </section>
  );
}

export function Specs({ runs }: { runs: Compared[] }) {
  const specs = runs.map(({ run }) => run.spec);
  const differing = useMemo(() => differences(specs), specs);
  return (
    <section class="card" aria-labelledby="compare-specs">
      <h2 id="compare-specs">Where the specs differ</h2>
      {differing.length === 0 && <p class="quiet">Nowhere: all of them are the same.</p>}
      {differing.length > 0 && (
        <Table runs={runs} corner="Field">
          {differing.map(({ path, values }) => (
            <tr key={path}>
              <th scope="row">
                <code>{path}</code>
              </th>
              {values.map((value, i) => (
                <td key={runs[i]!.run.id}>{written(value)}</td>
              ))}
            </tr>
          ))}
        </Table>
      )}
    </section>
  );
}

type TableProps = { runs: Compared[]; corner: string; children: ComponentChildren };

function Table({ runs, corner, children }: TableProps) {
  return (
    <div class="wide-table" tabIndex={0} role="region" aria-label={`${corner}s of the runs`}>
      <table>
        <thead>
          <tr>
            <th scope="col">{corner}</th>
            {runs.map(({ run, name, place }) => (
              <th key={run.id} scope="col">
                <LineKey index={place} /> {name}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>{children}</tbody>
      </table>
    </div>
  );
}
