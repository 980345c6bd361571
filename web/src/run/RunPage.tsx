/** The page of a run: status, figures, results and files. */

import type { Run } from "../api/types";
import type { Detail } from "../store/detail";
import type { Elites } from "../store/elites";
import { hasArchive, useExperiments, useRunDetail } from "../store/fetch";
import { lazy } from "../ui/lazy";
import { useRefusal } from "../store/principal";
import { useStore } from "../store/store";
import { editRun } from "../store/commands";
import { NotForceFree, forceFreeShare } from "../ui/coupling";
import { RunActivity, CommandButtons, StatusBadge, RunProgress, timeOf } from "./RunStatus";
import { type Figure, endReasonOf, figuresOf, generationsOf } from "./figures";
import { count, dateTime, number, shortId, titleOf } from "../ui/format";
import { NotFound, Page, useTitle } from "../ui/Page";
import { NameField } from "./NameField";
import { ArchiveRun } from "./ArchiveRun";
import { ForkLink } from "../ui/links";
import { ForkedFrom, BinNotice, LifecycleButtons } from "./Lifecycle";
import { LogCard } from "./LogCard";
import { SchedulingCard } from "./SchedulingCard";
import { PublishButton } from "../publish/PublishButton";
import { SpecCard } from "./spec/SpecCard";
import { text } from "./text";
import { Facts } from "../ui/Facts";
import "./run.css";

const FilesCard = lazy(async () => (await import("./FilesCard")).FilesCard, "section");
const GaitsRun = lazy(async () => (await import("./gaits/GaitsRun")).GaitsRun, "section");
const LearningRun = lazy(async () => (await import("./learning/LearningRun")).LearningRun, "section");
const PopulationCards = lazy(
  async () => (await import("./population/PopulationCards")).PopulationCards,
  "section",
);
const ScalingRun = lazy(async () => (await import("./scaling/ScalingRun")).ScalingRun, "section");

export function RunPage({ id, query }: { id: string; query: URLSearchParams }) {
  const { error } = useRunDetail(id);
  const run = useStore((state) => state.runs.get(id));
  const detail = useStore((state) => state.details.get(id));
  const experiments = useExperiments().value ?? [];
  const title = run ? titleOf(run, experiments) : text.run;
  useTitle(title);
  if (!run) {
    return <Page loading={!error}>{error && <NotFound what={text.noSuchRun} reason={error} id={id} />}</Page>;
  }
  return (
    <Page crumbs={run.sweep ? [[`/sweeps/${run.sweep}`, text.sweep]] : undefined}>
      <Header run={run} title={title} />
      {run.deleted_at ? <BinNotice run={run} /> : <RunSections {...{ run, title, query, error, detail }} />}
    </Page>
  );
}

function Header({ run, title }: { run: Run; title: string }) {
  const refusal = useRefusal(run);
  const forceFree = forceFreeShare(run.spec);
  return (
    <header class="page-head run-head">
      <NameField
        of={run}
        title={title}
        readOnly={!!refusal || !!run.deleted_at}
        onName={(name) => void editRun(run.id, { name })}
      >
        <h1>
          {title} <code>{shortId(run.id)}</code>
        </h1>
      </NameField>
      <StatusBadge run={run} />
      {run.status === "finished" && hasArchive(run) && <span class="quiet small">{endReasonOf(run)}</span>}
      {forceFree !== "all" && <NotForceFree some={forceFree === "some"} />}
      <span class="spring" />
      {hasArchive(run) && run.generation > 0 && !run.deleted_at && (
        <PublishButton of={{ run: run.id }} title={run.name ?? ""} />
      )}
      {hasArchive(run) && run.generation > 0 && !run.deleted_at && (
        <a class="button" href={`/runs/${run.id}/tree`} title={text.treeAbout}>
          {text.tree}
        </a>
      )}
      {hasArchive(run) && !!run.coverage && !run.deleted_at && <ForkLink run={run.id} title={text.fork} />}
      {refusal && !run.deleted_at && <span class="quiet small">{refusal}</span>}
      {!refusal && !run.deleted_at && <CommandButtons {...{ run, title }} name={title} />}
      {!refusal && <LifecycleButtons run={run} title={title} />}
    </header>
  );
}

interface SectionsProps {
  run: Run;
  title: string;
  query: URLSearchParams;
  error: string | null;
  detail: Detail | undefined;
}

function RunSections({ run, title, query, error, detail }: SectionsProps) {
  return (
    <>
      {error && <p class="banner wrong">{error}</p>}
      <Banners run={run} />
      <ForkedFrom run={run} />
      <RunFacts {...{ run, title }} />
      <RunActivity run={run} />
      {run.experiment === "gaits" && <GaitsRun run={run} query={query} />}
      {learns(run) && <LearningRun run={run} query={query} />}
      {run.experiment === "scaling" && <ScalingRun run={run} query={query} />}
      {hasArchive(run) && <ArchiveRun run={run} detail={detail} query={query} />}
      {run.experiment === "neuroevolution" && (
        <PopulationCards run={run} elites={detail?.elites ?? NO_ELITES} />
      )}
      <div class="run-columns even">
        <div class="stack">
          <LogCard run={run} query={query} />
          <SchedulingCard run={run} />
          <FilesCard run={run} about={text.filesAbout(hasArchive(run), dateTime(run.created_at), run)} />
        </div>
        <SpecCard run={run} query={query} />
      </div>
    </>
  );
}

const NO_ELITES: Elites = new Map();

function SectionLinks({ run: { experiment, spec } }: { run: Run }) {
  const search = "search" in spec;
  const sections = [
    search && ["archive", text.archive],
    search && ["curves", text.curves],
    experiment === "folding" && ["folds", text.pictures],
    experiment === "neuroevolution" && ["species", text.species],
    experiment === "neuroevolution" && ["network", text.network],
    ["log", text.log],
    ["spec", text.spec],
    ["files", text.files],
  ].filter((section) => section !== false);
  return (
    <nav class="sections small" aria-label={text.sections}>
      {sections.map(([id, name]) => (
        <a key={id} href={`#${id}`}>
          {name}
        </a>
      ))}
    </nav>
  );
}

/** True for experiments that take gradient steps. */
const learns = (run: Run) => ["folding", "refinement"].includes(run.experiment);

function Banners({ run }: { run: Run }) {
  return (
    <>
      {run.warning && (
        <p class="banner warning" role="status">
          {run.warning}
        </p>
      )}
      {run.error && !run.error_details && <p class="banner wrong">{run.error}</p>}
      {run.error && run.error_details && (
        <details class="banner wrong" open={run.status === "failed"}>
          <summary>{run.error}</summary>
          <pre>{run.error_details}</pre>
        </details>
      )}
    </>
  );
}

/** Progress and key figures, which stay at the top; once there, with the name of the run. */
function RunFacts({ run, title }: { run: Run; title: string }) {
  const time = timeOf(run);
  const work: Figure[] = [
    [text.evaluations, count(run.evaluations)],
    [text.evaluationsPerSecond, number(run.evaluations_per_second)],
  ];
  const facts: Figure[] = [
    [generationsOf(run), `${count(run.generation)} / ${count(run.generations)}`],
    [time.label, time.text],
    ...figuresOf(run),
    ...(hasArchive(run) ? work : []),
  ];
  return (
    <section class="run-facts" aria-label={text.status}>
      <RunProgress run={run} />
      <div class="run-line">
        <strong class="run-stuck" aria-hidden="true">
          {title}
        </strong>
        <Facts of={facts} />
        <SectionLinks run={run} />
      </div>
    </section>
  );
}
