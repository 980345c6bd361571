/** Results of a scaling run: wall time and memory against the number of nodes. */

import { bytes, number } from "../../ui/format";
import { Card } from "../../ui/Page";
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
