/** Tables of the figures of runs and of the differences of their specs. */

import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import type { Run } from "../api/types";
import { count, duration, number, percent } from "../ui/format";
import { timeOf } from "../run/RunStatus";
import { differences, written } from "../run/spec/difference";
import { LineKey } from "../charts/lineStyle";
import type { Compared } from "./Legend";
import { text } from "./text";
import { Term } from "../ui/Term";

const ROWS: [title: string, write: (run: Run) => string][] = [
  [text.qdScore, (run) => number(run.qd_score, 5)],
  [text.coverage, (run) => percent(run.coverage)],
  [text.bestFitness, (run) => number(run.best, 5)],
  [text.generations, (run) => `${count(run.generation)} / ${count(run.generations)}`],
  [text.evaluations, (run) => count(run.evaluations)],
  [text.diverged, (run) => count(run.diverged)],
  [text.evaluationsPerSecond, (run) => number(run.evaluations_per_second)],
  [text.time, (run) => (run.eta_seconds ? text.left(duration(run.eta_seconds)) : timeOf(run).text)],
  [text.device, (run) => run.device ?? "–"],
];

export function Figures({ runs }: { runs: Compared[] }) {
  return (
    <section class="card" aria-labelledby="compare-figures">
      <h2 id="compare-figures">{text.figures}</h2>
      <Table runs={runs} corner={text.figure}>
        {ROWS.map(([title, write]) => (
          <tr key={title}>
            <th scope="row">
              <Term name={title} />
            </th>
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
      <h2 id="compare-specs">{text.differences}</h2>
      {differing.length === 0 && <p class="quiet">{text.noDifferences}</p>}
      {differing.length > 0 && (
        <Table runs={runs} corner={text.field}>
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
    <div class="wide-table" tabIndex={0} role="region" aria-label={text.tableOf(corner)}>
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
