/** The comparison of runs: curves, figures, and differences of their specs. */

import { useMemo } from "preact/hooks";
import type { Experiment, Run } from "../api/types";
import { CurveOptions } from "../charts/curves/CurveOptions";
import { Curves } from "../charts/curves/Curves";
import { type OtherRun, curveViewOf, overlayPlots } from "../charts/curves/curveView";
import { type Plot, scoresOf } from "../charts/curves/plots";
import { LineSample, MAX_LINES, MAX_RUNS, colourOf, dashOf } from "../charts/lineStyle";
import { StatusBadge, timeOf } from "../run/RunStatus";
import { CORRECTED, SCORES, hasCorrected } from "../run/figures";
import { differences, groupsOf, valueText } from "../run/spec/difference";
import type { Curves as Columns } from "../store/curves";
import { hasArchive, useCurvesOf, useExperiments } from "../store/fetch";
import { setQuery } from "../store/router";
import { useRuns } from "../store/store";
import { lazy } from "../ui/lazy";
import { Card, Empty, Page } from "../ui/Page";
import { shortId, titleOf, DASH, count, duration, number } from "../ui/format";
import { ComparisonTable, type Row } from "./ComparisonTable";
import { CreaturesPage } from "./CreaturesPage";
import { text } from "./text";

const StatisticsCard = lazy(
  async () => (await import("../statistics/StatisticsCard")).StatisticsCard,
  "section",
);

/** Runs, or creatures if the address names them. */
export function ComparePage({ query }: { query: URLSearchParams }) {
  return query.has("creatures") ? <CreaturesPage query={query} /> : <RunsCompared query={query} />;
}

function RunsCompared({ query }: { query: URLSearchParams }) {
  const requested = [...new Set((query.get("runs") ?? "").split(",").filter(Boolean))];
  const ids = requested.slice(0, MAX_RUNS);
  const { value: curves, error } = useCurvesOf(ids);
  const known = useRuns(ids);
  const experiments = useExperiments().value ?? [];
  const runs = comparedOf(known, experiments);
  return (
    <Page
      title={text.compare}
      crumbs={[["/", text.runs]]}
      error={error}
      loading={ids.length > 0 && runs.length === 0}
    >
      {requested.length > MAX_RUNS && (
        <p class="banner warning">{text.tooMany(MAX_RUNS, requested.length)}</p>
      )}
      {ids.length === 0 && (
        <Empty title={text.nothingSelected} hint={text.nothingSelectedHint}>
          <a class="button primary" href="/">
            {text.showRuns}
          </a>
        </Empty>
      )}
      {runs.length > 0 && (
        <>
          <Legend runs={runs} ids={ids} />
          <Plots runs={runs} curves={curves ?? new Map()} query={query} />
          <Figures runs={runs} />
          {mayTest(runs) && <StatisticsCard of={{ runs: ids.join() }} corrected={runs.every(isCorrected)} />}
          <Specs runs={runs} />
        </>
      )}
    </Page>
  );
}

/** Each run has a line style of its own; with more runs than lines, each spec has one. */
function comparedOf(known: readonly (Run | undefined)[], experiments: Experiment[]): Compared[] {
  const runs = known.flatMap((run) => run ?? []);
  const lines = known.length > MAX_LINES ? groupsOf(runs.map(({ spec }) => spec)) : runs.map((_, i) => i);
  return runs.map((run, i) => ({ run, lineIndex: lines[i]!, name: nameOf(run, experiments) }));
}

/** Statistics need archives, runs that have ended, and two seeds of some spec. */
function mayTest(runs: Compared[]): boolean {
  const statuses = runs.map(({ run }) => run.status);
  const active = statuses.some((status) => ["queued", "running", "paused"].includes(status));
  const groups = new Set(groupsOf(runs.map(({ run }) => run.spec)));
  return (
    groups.size < runs.length &&
    !active &&
    statuses.includes("finished") &&
    runs.every(({ run }) => hasArchive(run))
  );
}

const isCorrected = ({ run }: Compared) => hasCorrected(run);

const nameOf = (run: Run, experiments: Experiment[]) =>
  run.name ?? `${titleOf(run, experiments)} ${shortId(run.id)}`;

function Legend({ runs, ids }: { runs: Compared[]; ids: string[] }) {
  const without = (id: string) => ids.filter((each) => each !== id).join() || null;
  return (
    <ul class="compare-legend" aria-label={text.runs}>
      {runs.map(({ run, name, lineIndex }) => (
        <li key={run.id}>
          <LineSample index={lineIndex} />
          <a href={`/runs/${run.id}`}>{name}</a>
          <StatusBadge run={run} />
          <button
            class="plain small-button"
            aria-label={text.remove(name)}
            onClick={() => setQuery({ runs: without(run.id) })}
          >
            ✕
          </button>
        </li>
      ))}
    </ul>
  );
}

interface PlotsProps {
  runs: Compared[];
  curves: ReadonlyMap<string, Columns>;
  query: URLSearchParams;
}

function Plots({ runs, curves, query }: PlotsProps) {
  const view = curveViewOf(query);
  const drawn = runs.flatMap(({ run, name, lineIndex }): OtherRun[] => {
    const own = curves.get(run.id);
    return own ? [{ name, colour: colourOf(lineIndex), dash: dashOf(lineIndex), curves: own }] : [];
  });
  return (
    <Card
      id="curves"
      kind="wide-curves"
      title={text.curves}
      note={runs.length > MAX_LINES ? text.bySpec : undefined}
    >
      <CurveOptions view={view} />
      <Curves plots={overlayPlots(oneLinePerRun, drawn, view)} view={view} />
    </Card>
  );
}

const oneLinePerRun = (curves: Columns): Plot[] =>
  scoresOf(curves).map((plot) => ({ ...plot, series: plot.series.slice(0, 1) }));

interface Compared {
  run: Run;
  name: string;
  /** Index of the line's colour and dash. */
  lineIndex: number;
}

type FormattedFigure = [title: string, format: (run: Run) => string];

const scoresAs = ([name, title, format]: (typeof SCORES | typeof CORRECTED)[number]): FormattedFigure => [
  title,
  (run) => format(run[name], 5),
];

const figuresOf = (runs: Run[]): FormattedFigure[] => [
  ...SCORES.map(scoresAs),
  ...(runs.some(hasCorrected) ? CORRECTED.map(scoresAs) : []),
  [text.generations, (run) => `${count(run.generation)} / ${count(run.generations)}`],
  [text.evaluations, (run) => count(run.evaluations)],
  [text.infeasible, (run) => count(run.infeasible)],
  [text.evaluationsPerSecond, (run) => number(run.evaluations_per_second)],
  [text.time, (run) => (run.eta_seconds ? text.left(duration(run.eta_seconds)) : timeOf(run).text)],
  [text.device, (run) => run.device ?? DASH],
];

function Figures({ runs }: { runs: Compared[] }) {
  const figures = figuresOf(runs.map(({ run }) => run));
  const rows = figures.map(([title, format]) => ({ title, values: runs.map(({ run }) => format(run)) }));
  return (
    <Card id="figures" title={text.figures}>
      <RunTable runs={runs} corner={text.figure} rows={rows} />
    </Card>
  );
}

function Specs({ runs }: { runs: Compared[] }) {
  const specs = runs.map(({ run }) => run.spec);
  const differing = useMemo(() => differences(specs), specs);
  const rows = differing.map(({ path, values }) => ({ title: path, values: values.map(valueText) }));
  return (
    <Card id="specs" title={text.differences}>
      {rows.length === 0 && <p class="quiet">{text.noDifferences}</p>}
      {rows.length > 0 && <RunTable runs={runs} corner={text.field} rows={rows} code />}
    </Card>
  );
}

function RunTable({ runs, ...rest }: { runs: Compared[]; corner: string; rows: Row[]; code?: boolean }) {
  const columns = runs.map(({ name, lineIndex }) => (
    <>
      <LineSample index={lineIndex} /> {name}
    </>
  ));
  return <ComparisonTable label={text.tableOf(rest.corner)} columns={columns} {...rest} />;
}
