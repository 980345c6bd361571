/** A run that learns by gradients: its curve, and its creatures before and after. */

import { useMemo } from "preact/hooks";
import type { ResultRow, Run } from "../../api/types";
import { useStore } from "../../store/store";
import { number, short } from "../../ui/format";
import { Plot } from "../../charts/plot/Plot";
import { Card } from "../../ui/Page";
import { ReplayPlayer } from "../../replay/ReplayPlayer";
import { courseOf } from "./learning";
import { FoldsCard } from "./FoldsCard";
import { RecordingStatus, useReplays } from "../../replay/recordings";
import { type ResultsProps, TableCard, hrefOf, useTable } from "../results/resultsPage";
import { text } from "./text";

export function LearningRun({ run, query }: ResultsProps) {
  const curves = useStore((state) => state.details.get(run.id))?.curves;
  const { results } = useTable(run);
  const course = curves && courseOf(run, curves);
  const rows = results?.rows ?? [];
  return (
    <>
      <Card id="course" kind="plot-card" title={course?.title ?? text.progress}>
        {course && course.lines.length > 0 ? (
          <Plot {...course} />
        ) : (
          <p class="quiet waiting">{text.firstStep}</p>
        )}
      </Card>
      {run.experiment === "folding" && <FoldsCard {...{ run, query, rows }} />}
      {run.experiment === "refinement" && run.status === "finished" && rows.length > 1 && (
        <Improvement run={run} before={rows[0]!} after={rows[rows.length - 1]!} />
      )}
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}

interface Ends {
  run: Run;
  before: ResultRow;
  after: ResultRow;
}

function Improvement({ run, before, after }: Ends) {
  return (
    <Card id="films" kind="films" title={text.beforeAndAfter}>
      {before.creature === after.creature ? (
        <p class="quiet">{text.unchanged}</p>
      ) : (
        <SideBySide {...{ run, before, after }} />
      )}
    </Card>
  );
}

function SideBySide({ run, before, after }: Ends) {
  const rendering = useReplays([before.creature!, after.creature!]);
  const [first, last] = rendering.replays ?? [];
  const films = useMemo(() => {
    if (!first || !last) return [];
    return [
      { replay: first, name: <Name {...{ run, row: before }} title={text.before} /> },
      { replay: last, name: <Name {...{ run, row: after }} title={text.after} /> },
    ];
  }, [run.id, first, last]);
  return (
    <>
      <RecordingStatus {...rendering} what={text.recordingBoth} />
      {films.length > 0 && <ReplayPlayer films={films} />}
    </>
  );
}

function Name({ run, row, title }: { run: Run; row: ResultRow; title: string }) {
  return (
    <>
      <b>{title}</b> {text.fitness(number(Number(row.fitness), 4))}{" "}
      <a href={hrefOf(run)(row.creature!)}>
        <code>{short(row.creature!)}</code>
      </a>
    </>
  );
}
