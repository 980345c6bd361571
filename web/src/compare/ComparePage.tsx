/** The comparison of runs: curves, figures, and differences of their specs. */

import type { Experiment, Run } from "../api/types";
import type { Curves as Columns } from "../store/curves";
import { useCurvesOf, useExperiments } from "../store/fetch";
import { useRuns } from "../store/store";
import { Curves } from "../charts/curves/Curves";
import { type OtherRun, curveViewOf, overlayPlots } from "../charts/curves/look";
import { type Plot, scoresOf } from "../charts/curves/plots";
import { short, titleOf } from "../ui/format";
import { MAX_LINES, colourOf, dashOf } from "../charts/lineStyle";
import { type Compared, Legend } from "./Legend";
import { Figures, Specs } from "./Tables";
import { CurveOptions } from "../charts/curves/CurveOptions";
import { text } from "./text";
import "./compare.css";

export function ComparePage({ query }: { query: URLSearchParams }) {
  const asked = [...new Set((query.get("runs") ?? "").split(",").filter(Boolean))];
  const ids = asked.slice(0, MAX_LINES);
  const { value: curves, error } = useCurvesOf(ids);
  const known = useRuns(ids);
  const experiments = useExperiments().value ?? [];
  const runs = known.flatMap((run, place): Compared[] =>
    run ? [{ run, place, name: nameOf(run, experiments) }] : [],
  );
  return (
    <main>
      <nav class="crumbs" aria-label={text.breadcrumbs}>
        <a href="/">{text.runs}</a>
      </nav>
      <header class="page-head">
        <h1>{text.compare}</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {asked.length > MAX_LINES && <p class="banner warning">{text.tooMany(MAX_LINES, asked.length)}</p>}
      {ids.length === 0 && <NothingChosen />}
      {ids.length > 0 && runs.length === 0 && !error && <p class="quiet loading">{text.loading}</p>}
      {runs.length > 0 && (
        <div class="compare">
          <Legend runs={runs} ids={ids} />
          <Plots runs={runs} curves={curves ?? new Map()} query={query} />
          <Figures runs={runs} />
          <Specs runs={runs} />
        </div>
      )}
    </main>
  );
}

const nameOf = (run: Run, experiments: Experiment[]) =>
  run.name ?? `${titleOf(run, experiments)} ${short(run.id)}`;

function NothingChosen() {
  return (
    <section class="empty card">
      <h2>{text.nothingChosen}</h2>
      <p>{text.nothingChosenHint}</p>
      <a class="button primary" href="/">
        {text.showRuns}
      </a>
    </section>
  );
}

interface PlotsProps {
  runs: Compared[];
  curves: ReadonlyMap<string, Columns>;
  query: URLSearchParams;
}

function Plots({ runs, curves, query }: PlotsProps) {
  const look = curveViewOf(query);
  const drawn = runs.flatMap(({ run, name, place }): OtherRun[] => {
    const own = curves.get(run.id);
    return own ? [{ name, colour: colourOf(place), dash: dashOf(place), curves: own }] : [];
  });
  return (
    <section class="card" aria-labelledby="compare-curves">
      <h2 id="compare-curves">{text.curves}</h2>
      <CurveOptions look={look} />
      <Curves plots={overlayPlots(oneLinePerRun, drawn, look)} x={NO_X} look={look} />
    </section>
  );
}

/** Each run has its own x values. */
const NO_X: readonly number[] = [];

/** One line a run. */
const oneLinePerRun = (curves: Columns): Plot[] =>
  scoresOf(curves).map((plot) => ({ ...plot, series: plot.series.slice(0, 1) }));
