/** One run: its archive, its curves, how it is doing, and its files. */

import { useEffect } from "preact/hooks";
import { archiveUrl, proveFile } from "../api/client";
import { messageOf } from "../api/problem";
import type { Axis, Run } from "../api/types";
import { useExperiments, useRunDetail } from "../live/fetching";
import { useLive } from "../live/live";
import type { Detail } from "../live/detail";
import { tell } from "../live/toasts";
import { navigate, setQuery } from "../router";
import { ArchiveMap } from "../view/archive/ArchiveMap";
import type { ColourBy } from "../view/archive/draw";
import { Curves } from "../view/Curves";
import { count, moment, number, percent, short, titleOf } from "../view/format";
import { Actions, Badge, Progress, rateOf, timeOf } from "../view/RunBits";
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
        <span class="spring" />
        <Actions run={run} on={ON(title)} name={title} />
      </header>
      {error && <p class="banner wrong">{error}</p>}
      <Banners run={run} />
      <Standing run={run} />
      <div class="run-columns">
        <ArchiveCard run={run} detail={detail} query={query} />
        <section class="card curves-card" aria-labelledby="curves-title">
          <h2 id="curves-title">Curves</h2>
          {detail?.curves && detail.curves.generation.length > 0 ? (
            <Curves curves={detail.curves} />
          ) : (
            <p class="quiet waiting">They begin with the first generation.</p>
          )}
        </section>
      </div>
      <Files run={run} />
    </main>
  );
}

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

function Standing({ run }: { run: Run }) {
  const time = timeOf(run);
  const facts: [string, string][] = [
    ["Generation", `${count(run.generation)} / ${count(run.generations)}`],
    [time.label, time.text],
    ["Evaluations", count(run.evaluations)],
    ["Evaluations/s", rateOf(run)],
    ["QD score", number(run.qd_score)],
    ["Coverage", percent(run.coverage)],
    ["Best fitness", number(run.best)],
    ["Diverged", count(run.diverged)],
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

interface ArchiveProps {
  run: Run;
  detail: Detail | undefined;
  query: URLSearchParams;
}

function ArchiveCard({ run, detail, query }: ArchiveProps) {
  const colourBy: ColourBy = query.get("colour") === "generation" ? "generation" : "fitness";
  const cell = query.get("cell");
  const elites = detail?.elites;
  const open = (chosen: number) => {
    setQuery({ cell: String(chosen) });
    navigate(`/creatures/${elites!.get(chosen)!.creature}?run=${run.id}`);
  };
  return (
    <section class="card" aria-labelledby="archive-title">
      <div class="card-head">
        <h2 id="archive-title">Archive</h2>
        <span class="quiet">{detail?.archive && elites ? `${count(elites.size)} elites` : ""}</span>
        <span class="spring" />
        <label class="compact">
          Colour
          <select
            value={colourBy}
            onChange={({ currentTarget: { value } }) =>
              setQuery({ colour: value === "fitness" ? null : value })
            }
          >
            <option value="fitness">fitness</option>
            <option value="generation">generation</option>
          </select>
        </label>
      </div>
      {detail?.archive && elites ? (
        <ArchiveMap
          axes={detail.archive.axes as [Axis, Axis]}
          elites={elites}
          colourBy={colourBy}
          marked={cell === null ? null : Number(cell)}
          onMark={(marked) => setQuery({ cell: String(marked) })}
          onOpen={open}
        />
      ) : (
        <p class="quiet waiting">Loading the archive …</p>
      )}
    </section>
  );
}

function Files({ run }: { run: Run }) {
  const spec = JSON.stringify(run.spec, null, 2);
  const href = `data:application/json;charset=utf-8,${encodeURIComponent(spec)}`;
  return (
    <section class="card files" aria-labelledby="files-title">
      <h2 id="files-title">Files</h2>
      <p class="links">
        <ArchiveLink url={archiveUrl(run.id, "h5")} name="archive.h5" />
        <ArchiveLink url={archiveUrl(run.id, "csv")} name="archive.csv" />
        <a class="button" href={href} download={`${short(run.id)}-spec.json`}>
          spec.json
        </a>
      </p>
      <p class="quiet">
        Archive files are of the last checkpoint. Created {moment(run.created_at)}, attempt{" "}
        {run.attempt}, version {run.version}
        {run.device && `, on ${run.device}`}.
      </p>
      <details>
        <summary>Spec</summary>
        <pre>{spec}</pre>
      </details>
    </section>
  );
}

/** A download that says why where there is no file yet. */
function ArchiveLink({ url, name }: { url: string; name: string }) {
  const download = (event: MouseEvent) => {
    event.preventDefault();
    proveFile(url)
      .then(() => location.assign(url))
      .catch((error) => tell({ kind: "wrong", text: messageOf(error) }));
  };
  return (
    <a class="button" href={url} onClick={download}>
      {name}
    </a>
  );
}
