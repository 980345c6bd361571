/** The comparison of runs: curves, figures, and differences of their specs. */

import type { Experiment, Run } from "../api/types";
import type { Curves as Columns } from "../store/curves";
import { useCurvesOf, useExperiments } from "../store/fetch";
import { setQuery } from "../store/router";
import { useRuns } from "../store/store";
import { Curves } from "../charts/curves/Curves";
import { type OtherRun, curveViewOf, overlayPlots } from "../charts/curves/look";
import { type Plot, scoresOf } from "../charts/curves/plots";
import { short, titleOf } from "../ui/format";
import { LineKey, MAX_LINES, colourOf, dashOf } from "../charts/lineStyle";
import { StatusBadge } from "../run/RunStatus";
import { Card, Empty, Page } from "../ui/Page";
import { type Compared, Figures, Specs } from "./Tables";
import { CurveOptions } from "../charts/curves/CurveOptions";
import { text } from "./text";

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
    <Page
      title={text.compare}
      crumbs={[["/", text.runs]]}
      error={error}
      loading={ids.length > 0 && runs.length === 0 && text.loading}
    >
      {asked.length > MAX_LINES && <p class="banner warning">{text.tooMany(MAX_LINES, asked.length)}</p>}
      {ids.length === 0 && (
        <Empty title={text.nothingChosen} hint={text.nothingChosenHint}>
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
          <Specs runs={runs} />
        </>
      )}
    </Page>
  );
}

const nameOf = (run: Run, experiments: Experiment[]) =>
  run.name ?? `${titleOf(run, experiments)} ${short(run.id)}`;

function Legend({ runs, ids }: { runs: Compared[]; ids: string[] }) {
  const without = (id: string) => ids.filter((each) => each !== id).join() || null;
  return (
    <ul class="compare-legend" aria-label={text.runs}>
      {runs.map(({ run, name, place }) => (
        <li key={run.id}>
          <LineKey index={place} />
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
  const look = curveViewOf(query);
  const drawn = runs.flatMap(({ run, name, place }): OtherRun[] => {
    const own = curves.get(run.id);
    return own ? [{ name, colour: colourOf(place), dash: dashOf(place), curves: own }] : [];
  });
  return (
    <Card id="curves" kind="wide-curves" title={text.curves}>
      <CurveOptions look={look} />
      <Curves plots={overlayPlots(oneLinePerRun, drawn, look)} x={NO_X} look={look} />
    </Card>
  );
}

/** Each run has its own x values. */
const NO_X: readonly number[] = [];

const oneLinePerRun = (curves: Columns): Plot[] =>
  scoresOf(curves).map((plot) => ({ ...plot, series: plot.series.slice(0, 1) }));
