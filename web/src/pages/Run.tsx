/** One run: how it is doing, what it has come to, and its files. */

import { useEffect } from "preact/hooks";
import type { Run } from "../api/types";
import { hasArchive, useExperiments, useRunDetail } from "../live/fetching";
import { useLive } from "../live/live";
import { freedomOf } from "../view/coupling";
import { endingOf } from "../view/ending";
import { count, short, titleOf } from "../view/format";
import { NotFree } from "../view/NotFree";
import { type Figure, figuresOf, generationsOf } from "../view/results/figures";
import { Actions, Badge, Progress, rateOf, timeOf } from "../view/RunBits";
import { ArchiveRun } from "./ArchiveRun";
import { Files } from "./Files";
import { GaitsRun } from "./GaitsRun";
import { LearningRun } from "./LearningRun";
import { ScalingRun } from "./ScalingRun";
import { ON } from "./wishes";

interface Props {
  id: string;
  query: URLSearchParams;
}

export function RunPage({ id, query }: Props) {
  const { error } = useRunDetail(id);
  const run = useLive((state) => state.runs.get(id));
  const detail = useLive((state) => state.details.get(id));
  const title = useTitle(run);
  useEffect(() => {
    document.title = `${title} · Microcosmos`;
  }, [title]);
  if (!run) {
    return (
      <main>
        {error ? <p class="banner wrong">{error}</p> : <p class="quiet loading">Loading run …</p>}
      </main>
    );
  }
  const freedom = freedomOf(run.spec);
  return (
    <main>
      <nav class="crumbs" aria-label="Where you are">
        <a href="/">Runs</a>
      </nav>
      <header class="page-head">
        <h1>
          {title} <code>{short(run.id)}</code>
        </h1>
        <Badge run={run} />
        {freedom !== "all" && <NotFree some={freedom === "some"} />}
        <span class="spring" />
        <Actions run={run} on={ON(title)} name={title} />
      </header>
      {error && <p class="banner wrong">{error}</p>}
      <Banners run={run} />
      <Standing run={run} />
      {run.status === "finished" && hasArchive(run) && <p class="quiet ending">{endingOf(run)}</p>}
      {run.experiment === "gaits" && <GaitsRun run={run} query={query} />}
      {learns(run) && <LearningRun run={run} query={query} />}
      {run.experiment === "scaling" && <ScalingRun run={run} query={query} />}
      {hasArchive(run) && <ArchiveRun run={run} detail={detail} query={query} />}
      <Files run={run} />
    </main>
  );
}

/** By gradients, from step to step. */
const learns = (run: Run) => ["folding", "refinement"].includes(run.experiment);

function useTitle(run: Run | undefined): string {
  const experiments = useExperiments().value ?? [];
  return run ? titleOf(run, experiments) : "Run";
}

function Banners({ run }: { run: Run }) {
  return (
    <>
      {run.warning && (
        <p class="banner warning" role="status">
          {run.warning}
        </p>
      )}
      {run.error && (
        <details class="banner wrong" open={run.status === "failed"}>
          <summary>{run.error.trim().split("\n").at(-1)}</summary>
          <pre>{run.error}</pre>
        </details>
      )}
    </>
  );
}

const searching = (run: Run): Figure[] => [
  ["Evaluations", count(run.evaluations)],
  ["Evaluations/s", rateOf(run)],
];

function Standing({ run }: { run: Run }) {
  const time = timeOf(run);
  const facts: Figure[] = [
    [generationsOf(run), `${count(run.generation)} / ${count(run.generations)}`],
    [time.label, time.text],
    ...(hasArchive(run) ? searching(run) : []),
    ...figuresOf(run),
  ];
  return (
    <section class="standing" aria-label="How the run is doing">
      <Progress run={run} />
      <dl class="facts">
        {facts.map(([name, value]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
