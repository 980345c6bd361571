/** One run: how it is doing, what it has come to, and its files. */

import { useEffect } from "preact/hooks";
import type { Run } from "../api/types";
import type { Detail } from "../live/detail";
import type { Elites } from "../live/elites";
import { hasArchive, useExperiments, useRunDetail } from "../live/fetching";
import { useFresh } from "../live/repeating";
import { later } from "../later";
import { useRefusal } from "../live/caller";
import { useLive } from "../live/live";
import { useNow } from "../live/runpage";
import { say } from "../live/saying";
import { freedomOf } from "../view/coupling";
import { Doing, doingOf } from "../view/Doing";
import { endingOf } from "../view/ending";
import { count, number, short, titleOf } from "../view/format";
import { NotFree } from "../view/NotFree";
import { NotThere } from "../view/NotThere";
import { type Figure, figuresOf, generationsOf } from "../view/results/figures";
import { Actions, Badge, Progress, timeOf } from "../view/RunBits";
import { Name } from "../view/runs/Said";
import { ArchiveRun } from "./ArchiveRun";
import { Files } from "./Files";
import { ForkLink } from "./ForkLink";
import { ForkedFrom, InBin, Life } from "./Life";
import { LogCard } from "./LogCard";
import { Publish } from "./Publish";
import { SpecCard } from "./SpecCard";
import { ON } from "./wishes";

const GaitsRun = later(async () => (await import("./GaitsRun")).GaitsRun, "section");
const LearningRun = later(async () => (await import("./LearningRun")).LearningRun, "section");
const PopulationCards = later(async () => (await import("./PopulationCards")).PopulationCards, "section");
const ScalingRun = later(async () => (await import("./ScalingRun")).ScalingRun, "section");

interface Props {
  id: string;
  query: URLSearchParams;
}

export function RunPage({ id, query }: Props) {
  const { error } = useRunDetail(id);
  const run = useLive((state) => state.runs.get(id));
  const detail = useLive((state) => state.details.get(id));
  const title = useTitle(run);
  const refusal = useRefusal(run);
  useEffect(() => {
    document.title = `${title} · Microcosmos`;
  }, [title]);
  if (!run) {
    return (
      <main>
        {error ? <NotThere what="No such run" reason={error} /> : <p class="quiet loading">Loading run …</p>}
      </main>
    );
  }
  const freedom = freedomOf(run.spec);
  return (
    <main>
      <nav class="crumbs" aria-label="Where you are">
        <a href="/">Runs</a>
        {run.sweep && <a href={`/sweeps/${run.sweep}`}>Sweep</a>}
      </nav>
      <header class="page-head">
        <Name
          of={run}
          title={title}
          fixed={!!refusal || !!run.deleted_at}
          onName={(name) => void say(id, { name })}
        >
          <h1>
            {title} <code>{short(run.id)}</code>
          </h1>
        </Name>
        <Badge run={run} />
        {freedom !== "all" && <NotFree some={freedom === "some"} />}
        <span class="spring" />
        {hasArchive(run) && run.generation > 0 && !run.deleted_at && (
          <Publish of={{ run: run.id }} title={run.name ?? ""} />
        )}
        {hasArchive(run) && !!run.coverage && !run.deleted_at && (
          <ForkLink run={run.id} title="A new run that begins from the creatures of this one" />
        )}
        {refusal && !run.deleted_at && <span class="quiet small">{refusal}</span>}
        {!refusal && !run.deleted_at && <Actions run={run} on={ON(title)} name={title} />}
        {!refusal && <Life run={run} title={title} />}
      </header>
      {run.deleted_at ? <InBin run={run} /> : <Whole {...{ run, query, error, detail }} />}
    </main>
  );
}

interface WholeProps {
  run: Run;
  query: URLSearchParams;
  error: string | null;
  detail: Detail | undefined;
}

function Whole({ run, query, error, detail }: WholeProps) {
  return (
    <>
      {error && <p class="banner wrong">{error}</p>}
      <Banners run={run} />
      <ForkedFrom run={run} />
      <Standing run={run} />
      <Now run={run} />
      <Sections run={run} />
      {run.status === "finished" && hasArchive(run) && <p class="quiet ending">{endingOf(run)}</p>}
      {run.experiment === "gaits" && <GaitsRun run={run} query={query} />}
      {learns(run) && <LearningRun run={run} query={query} />}
      {run.experiment === "scaling" && <ScalingRun run={run} query={query} />}
      {hasArchive(run) && <ArchiveRun run={run} detail={detail} query={query} />}
      {run.experiment === "neuroevolution" && <PopulationCards run={run} elites={detail?.elites ?? NOBODY} />}
      <div class="run-columns record">
        <div class="stack">
          <LogCard run={run} query={query} />
          <Files run={run} />
        </div>
        <SpecCard run={run} query={query} />
      </div>
    </>
  );
}

const NOBODY: Elites = new Map();

/** What it is doing while its figures do not tell yet; how long it has been at it. */
function Now({ run }: { run: Run }) {
  const asked = doingOf(run) !== null;
  const now = useNow(asked);
  useFresh(run.id, run.status === "queued");
  return asked ? <Doing run={run} now={now} /> : null;
}

/** Ways within a long page. */
function Sections({ run }: { run: Run }) {
  const kinds: Record<string, [id: string, name: string][]> = {
    folding: [["folds", "Pictures"]],
    neuroevolution: [
      ["species", "Species"],
      ["network", "Network"],
    ],
  };
  const sections: [id: string, name: string][] = [
    ...(hasArchive(run)
      ? ([
          ["archive", "Archive"],
          ["curves", "Curves"],
        ] as [string, string][])
      : []),
    ...(kinds[run.experiment] ?? []),
    ["log", "Log"],
    ["spec", "Spec"],
    ["files", "Files"],
  ];
  return (
    <nav class="sections" aria-label="Parts of this page">
      {sections.map(([id, name]) => (
        <a key={id} href={`#${id}`}>
          {name}
        </a>
      ))}
    </nav>
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
  ["Evaluations/s", number(run.evaluations_per_second)],
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
