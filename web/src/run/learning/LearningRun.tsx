/** A run that learns by gradients: its curve, and its creatures before and after. */

import { useMemo } from "preact/hooks";
import type { ResultRow, Run } from "../../api/types";
import { Plot, type Axis, type Line, type PlotProps } from "../../charts/plot/Plot";
import { fromZero, logAround } from "../../charts/plot/scale";
import { newPlayhead } from "../../replay/clock";
import { ReplayPlayer } from "../../replay/ReplayPlayer";
import { ReplayStatus, useReplays } from "../../replay/replays";
import type { Curves } from "../../store/curves";
import { keyOf } from "../../store/figureNames";
import { useStore } from "../../store/store";
import { Card } from "../../ui/Page";
import { number, shortId, count } from "../../ui/format";
import { type ResultsProps, TableCard, hrefOf, useResultsTable } from "../results/ResultsTable";
import { FoldsCard } from "./FoldsCard";
import { text } from "./text";

export function LearningRun({ run, query }: ResultsProps) {
  const curves = useStore((state) => state.details.get(run.id))?.curves;
  const { results } = useResultsTable(run);
  const curve = curves && learningCurveOf(run, curves);
  const rows = results?.rows ?? [];
  return (
    <>
      <Card id="curve" kind="plot-card" title={curve?.title ?? text.progress}>
        {curve && curve.lines.length > 0 ? (
          <Plot {...curve} />
        ) : (
          <p class="quiet waiting">{text.firstStep}</p>
        )}
      </Card>
      {run.experiment === "folding" && <FoldsCard {...{ run, query, rows }} />}
      {run.experiment === "refinement" && run.status === "finished" && rows.length > 1 && (
        <Improvement {...{ run, query }} before={rows[0]!} after={rows[rows.length - 1]!} />
      )}
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}

interface Pair extends ResultsProps {
  before: ResultRow;
  after: ResultRow;
}

function Improvement(pair: Pair) {
  const changed = pair.before.creature !== pair.after.creature;
  return (
    <Card id="improvement" title={text.beforeAndAfter}>
      {changed ? <SideBySide {...pair} /> : <p class="quiet">{text.unchanged}</p>}
    </Card>
  );
}

function SideBySide({ run, query, before, after }: Pair) {
  const playhead = useMemo(newPlayhead, []);
  const rendering = useReplays([before.creature!, after.creature!]);
  const [first, last] = rendering.replays ?? [];
  const panels = useMemo(() => {
    if (!first || !last) return [];
    return [
      { replay: first, name: <CreatureLink {...{ run, row: before }} title={text.before} /> },
      { replay: last, name: <CreatureLink {...{ run, row: after }} title={text.after} /> },
    ];
  }, [run.id, first, last]);
  return (
    <>
      <ReplayStatus {...rendering} what={text.recordingBoth} />
      {panels.length > 0 && <ReplayPlayer {...{ panels, playhead, query }} />}
    </>
  );
}

function CreatureLink({ run, row, title }: { run: Run; row: ResultRow; title: string }) {
  return (
    <>
      <b>{title}</b> {text.fitness(number(Number(row.fitness), 4))}{" "}
      <a href={hrefOf(run)(row.creature!)}>
        <code>{shortId(row.creature!)}</code>
      </a>
    </>
  );
}

/** The largest number of marks on a line. */
const MAX_MARKS = 120;

/** The loss of each filament, or the fitness of a creature, by step. */
export function learningCurveOf(run: Run, curves: Curves): PlotProps {
  const folds = run.experiment === "folding";
  // A refinement measures its creature before the first step.
  const before = folds ? 0 : 1;
  const names = Object.keys(curves.summary).filter((name) =>
    folds ? keyOf("loss.*", name) !== null : name === "fitness",
  );
  const lines = names.map((name, k) => lineOf(name, curves, before, k));
  const values = lines.flatMap(({ points }) => points.map(({ y }) => y ?? 0));
  const range = paddedScale(values);
  const steps = { log: false, low: 0, high: Math.max(1, run.generations - before) };
  return {
    title: folds ? text.lossAgainstUpdates : text.fitnessAgainstSteps,
    x: { title: folds ? text.update : text.stepAxis, scale: steps, format: count },
    y: folds
      ? { title: text.lossAxis, scale: logAround(values), format: (value) => number(value, 2) }
      : { title: text.fitnessAxis, scale: range, format: (value) => number(value, digitsOf(range)) },
    lines,
  };
}

function lineOf(column: string, curves: Curves, before: number, k: number): Line {
  const [name, values] = [keyOf("loss.*", column) ?? column, curves.summary[column]!];
  const step = (i: number) => curves.generation[i]! - before;
  const every = Math.max(1, Math.ceil(values.length / MAX_MARKS));
  const marked = values.map((_, i) => i).filter((i) => i % every === 0 || i === values.length - 1);
  return {
    name,
    colour: `--series-${1 + (k % 5)}`,
    ...(k >= 5 && { dash: "6 4" }),
    points: marked
      .filter((i) => values[i] !== null)
      .map((i) => ({
        x: step(i),
        y: values[i]!,
        tooltip: [name, text.afterCount(count(step(i))), number(values[i]!)],
      })),
  };
}

/** A linear scale that need not start at zero. */
function paddedScale(values: number[]): Axis["scale"] {
  if (values.length === 0) return fromZero([1]);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const margin = 0.07 * (high - low || Math.abs(high) || 1);
  return { log: false, low: low - margin, high: high + margin };
}

/** Digits that tell the ticks of an axis apart. */
const digitsOf = ({ low, high }: Axis["scale"]) =>
  2 + Math.max(0, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / (high - low))));
