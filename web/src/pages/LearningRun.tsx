/** A run that learns by gradients: its course, and the creatures it has come to. */

import { useLive } from "../live/live";
import { Plot } from "../view/plot/Plot";
import { courseOf } from "../view/results/learning";
import { type Props, TableCard, useTable } from "./results";

export function LearningRun({ run, query }: Props) {
  const curves = useLive((state) => state.details.get(run.id))?.curves;
  const { results } = useTable(run);
  const course = curves && courseOf(run, curves);
  const rows = results?.rows ?? [];
  return (
    <>
      <section class="card plot-card" aria-labelledby="course-title">
        <h2 id="course-title">{course?.title ?? "Course"}</h2>
        {course && course.lines.length > 0 ? (
          <Plot {...course} />
        ) : (
          <p class="quiet waiting">The first step is being computed …</p>
        )}
        {run.experiment === "folding" && rows.length === 0 && (
          <p class="quiet small">Filaments can be watched once all updates are done.</p>
        )}
      </section>
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}
