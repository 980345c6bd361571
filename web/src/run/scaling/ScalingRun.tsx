/** A measurement of wall time: parts, memory and exponents against the number of nodes. */

import { bytes, number } from "../../ui/format";
import { Plot } from "../../charts/plot/Plot";
import { logAxis, memoryLines, nodesAxis, timeLines } from "./scaling";
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
      <div class="run-columns scaling">
        <section class="card plot-card" aria-labelledby="time-title">
          <h2 id="time-title">{text.wallTime}</h2>
          <Plot
            title={text.wallTimePlot}
            x={x}
            y={logAxis(text.seconds, times, (value) => number(value, 2))}
            lines={times}
          />
        </section>
        <section class="card plot-card" aria-labelledby="memory-title">
          <h2 id="memory-title">{text.memory}</h2>
          <Plot title={text.memoryPlot} x={x} y={logAxis(text.memory, memory, bytes)} lines={memory} />
        </section>
      </div>
      <TableCard run={run} query={query} rows={rows} />
    </>
  );
}
