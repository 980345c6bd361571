/** One run: how it is doing, what it has come to, and its files. */

import { useEffect } from "preact/hooks";
import type { Run } from "../api/types";
import type { Detail } from "../store/detail";
import type { Elites } from "../store/elites";
import { hasArchive, useExperiments, useRunDetail } from "../store/fetch";
import { useRunRefresh } from "../store/refresh";
import { lazy } from "../ui/lazy";
import { useRefusal } from "../store/principal";
import { useStore } from "../store/store";
import { useNow } from "../store/runPage";
import { editRun } from "../store/commands";
import { forceFreeShare } from "../ui/coupling";
import { RunActivity, activityOf } from "./RunActivity";
import { endReasonOf } from "./endReason";
import { count, number, short, titleOf } from "../ui/format";
import { NotForceFree } from "../ui/NotForceFree";
import { NotFound } from "../ui/NotFound";
import { type Figure, figuresOf, generationsOf } from "./figures";
import { CommandButtons, StatusBadge, RunProgress, timeOf } from "./RunStatus";
import { NameField } from "./RunLabels";
import { ArchiveRun } from "./ArchiveRun";
import { FilesCard } from "./FilesCard";
import { ForkLink } from "../ui/ForkLink";
import { ForkedFrom, BinNotice, LifecycleButtons } from "./Lifecycle";
import { LogCard } from "./LogCard";
import { PublishButton } from "../publish/PublishButton";
import { SpecCard } from "./spec/SpecCard";
import { commandsFor } from "./runCommands";
import { text } from "./text";
import { Term } from "../ui/Term";
import "./run.css";

const GaitsRun = lazy(async () => (await import("./gaits/GaitsRun")).GaitsRun, "section");
const LearningRun = lazy(async () => (await import("./learning/LearningRun")).LearningRun, "section");
const PopulationCards = lazy(
  async () => (await import("./population/PopulationCards")).PopulationCards,
  "section",
);
const ScalingRun = lazy(async () => (await import("./scaling/ScalingRun")).ScalingRun, "section");

interface Props {
  id: string;
  query: URLSearchParams;
}

export function RunPage({ id, query }: Props) {
  const { error } = useRunDetail(id);
  const run = useStore((state) => state.runs.get(id));
  const detail = useStore((state) => state.details.get(id));
  const title = useTitle(run);
  useEffect(() => {
    document.title = text.pageTitle(title);
  }, [title]);
  if (!run) {
    return (
      <main>
        {error ? (
          <NotFound what={text.noSuchRun} reason={error} id={id} />
        ) : (
          <p class="quiet loading">{text.loadingRun}</p>
        )}
      </main>
    );
  }
  return (
    <main>
      <nav class="crumbs" aria-label={text.breadcrumbs}>
        <a href="/">{text.runs}</a>
        {run.sweep && <a href={`/sweeps/${run.sweep}`}>{text.sweep}</a>}
      </nav>
      <Header run={run} title={title} />
      {run.deleted_at ? <BinNotice run={run} /> : <RunSections {...{ run, query, error, detail }} />}
    </main>
  );
}

function Header({ run, title }: { run: Run; title: string }) {
  const refusal = useRefusal(run);
  const forceFree = forceFreeShare(run.spec);
  return (
    <header class="page-head">
      <NameField
        of={run}
        title={title}
        fixed={!!refusal || !!run.deleted_at}
        onName={(name) => void editRun(run.id, { name })}
      >
        <h1>
          {title} <code>{short(run.id)}</code>
        </h1>
      </NameField>
      <StatusBadge run={run} />
      {forceFree !== "all" && <NotForceFree some={forceFree === "some"} />}
      <span class="spring" />
      {hasArchive(run) && run.generation > 0 && !run.deleted_at && (
        <PublishButton of={{ run: run.id }} title={run.name ?? ""} />
      )}
      {hasArchive(run) && !!run.coverage && !run.deleted_at && <ForkLink run={run.id} title={text.fork} />}
      {refusal && !run.deleted_at && <span class="quiet small">{refusal}</span>}
      {!refusal && !run.deleted_at && <CommandButtons run={run} on={commandsFor(title)} name={title} />}
      {!refusal && <LifecycleButtons run={run} title={title} />}
    </header>
  );
}

interface SectionsProps {
  run: Run;
  query: URLSearchParams;
  error: string | null;
  detail: Detail | undefined;
}

function RunSections({ run, query, error, detail }: SectionsProps) {
  return (
    <>
      {error && <p class="banner wrong">{error}</p>}
      <Banners run={run} />
      <ForkedFrom run={run} />
      <RunFacts run={run} />
      <CurrentActivity run={run} />
      <SectionLinks run={run} />
      {run.status === "finished" && hasArchive(run) && <p class="quiet ending">{endReasonOf(run)}</p>}
      {run.experiment === "gaits" && <GaitsRun run={run} query={query} />}
      {learns(run) && <LearningRun run={run} query={query} />}
      {run.experiment === "scaling" && <ScalingRun run={run} query={query} />}
      {hasArchive(run) && <ArchiveRun run={run} detail={detail} query={query} />}
      {run.experiment === "neuroevolution" && (
        <PopulationCards run={run} elites={detail?.elites ?? NO_ELITES} />
      )}
      <div class="run-columns run-record">
        <div class="stack">
          <LogCard run={run} query={query} />
          <FilesCard run={run} />
        </div>
        <SpecCard run={run} query={query} />
      </div>
    </>
  );
}

const NO_ELITES: Elites = new Map();

/** What it is doing while its figures do not tell yet; how long it has been at it. */
function CurrentActivity({ run }: { run: Run }) {
  const asked = activityOf(run) !== null;
  const now = useNow(asked);
  useRunRefresh(run.id, run.status === "queued" || run.status === "running");
  return asked ? <RunActivity run={run} now={now} /> : null;
}

/** Ways within a long page. */
function SectionLinks({ run }: { run: Run }) {
  const kinds: Record<string, [id: string, name: string][]> = {
    folding: [["folds", text.pictures]],
    neuroevolution: [
      ["species", text.species],
      ["network", text.network],
    ],
  };
  const sections: [id: string, name: string][] = [
    ...(hasArchive(run)
      ? ([
          ["archive", text.archive],
          ["curves", text.curves],
        ] as [string, string][])
      : []),
    ...(kinds[run.experiment] ?? []),
    ["log", text.log],
    ["spec", text.spec],
    ["files", text.files],
  ];
  return (
    <nav class="sections" aria-label={text.sections}>
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
  return run ? titleOf(run, experiments) : text.run;
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

const searchFacts = (run: Run): Figure[] => [
  [text.evaluations, count(run.evaluations)],
  [text.evaluationsPerSecond, number(run.evaluations_per_second)],
];

function RunFacts({ run }: { run: Run }) {
  const time = timeOf(run);
  const facts: Figure[] = [
    [generationsOf(run), `${count(run.generation)} / ${count(run.generations)}`],
    [time.label, time.text],
    ...(hasArchive(run) ? searchFacts(run) : []),
    ...figuresOf(run),
  ];
  return (
    <section class="run-facts" aria-label={text.status}>
      <RunProgress run={run} />
      <dl class="facts">
        {facts.map(([name, value]) => (
          <div key={name}>
            <dt>
              <Term name={name} />
            </dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
