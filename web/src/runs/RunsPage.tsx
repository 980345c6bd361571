/** The list of runs: search, sort, rename, compare. */

import { useState } from "preact/hooks";
import { MAX_RUNS } from "../charts/lineStyle";
import type { RunQuery, SweepPage } from "../api/types";
import { useRefusal } from "../store/principal";
import { useExperiments } from "../store/fetch";
import { loadMoreRuns, useRunList, useTags } from "../store/runList";
import { useStore } from "../store/store";
import { useSweeps } from "../store/sweeps";
import { showFailure } from "../store/toasts";
import { setQuery } from "../store/router";
import { hasTakenTour } from "../archive/tour";
import { Tank } from "../tank/Tank";
import { Empty, Page } from "../ui/Page";
import { Filters, NO_FILTERS, WITHOUT_SWEEP, groupsSweeps, isFiltered, queryOf } from "./Filters";
import { RunTable, TAGS_ID } from "./RunTable";
import { TableOptions } from "./TableOptions";
import { text } from "./text";
import "./runs.css";
import { dateTime } from "../ui/format";
import { SweepProgress, SweepStates, sizeText, sweepTitle } from "../sweeps/SweepStatus";

/** Number of sweeps above the list, at first and after “Show more”. */
const FIRST_SWEEPS = 5;
const MAX_SWEEPS = 100;

export function RunsPage({ query: address }: { query: URLSearchParams }) {
  const query = queryOf(address);
  const grouped = groupsSweeps(query);
  const listedQuery: RunQuery = grouped ? { sweep: WITHOUT_SWEEP } : query;
  const { value: fetched, error } = useRunList(listedQuery);
  const [maxSweeps, setMaxSweeps] = useState(FIRST_SWEEPS);
  const sweeps = useSweeps(maxSweeps, grouped).value;
  const listed = useStore((state) => state.listed);
  const next = useStore((state) => state.next);
  const experiments = useExperiments().value ?? [];
  const tags = useTags();
  const [selected, setSelected] = useState<string[]>([]);
  const choose = (id: string) =>
    setSelected((old) => (old.includes(id) ? old.filter((each) => each !== id) : [...old, id]));
  const hasSweeps = grouped && (sweeps?.items.length ?? 0) > 0;
  const empty = fetched && listed.length === 0 && !hasSweeps;
  return (
    <>
      {!query.deleted && <Tank />}
      <Page
        title={query.deleted ? text.bin : text.runs}
        actions={<HeaderLinks bin={query.deleted ?? false} />}
        error={error}
        loading={!fetched && listed.length === 0}
      >
        <Welcome />
        {(listed.length > 0 || hasSweeps || isFiltered(query)) && (
          <div class="row list-options">
            <Filters query={query} experiments={experiments} tags={tags} onChange={setQuery} />
            <TableOptions address={address} />
          </div>
        )}
        {selected.length > 0 && <CompareBar ids={selected} {...{ listed }} onSelect={setSelected} />}
        {empty && <NothingListed query={query} />}
        {query.sweep && <SweepBanner sweep={query.sweep} />}
        {hasSweeps && (
          <SweepRows page={sweeps!} onMore={maxSweeps < MAX_SWEEPS ? () => setMaxSweeps(MAX_SWEEPS) : null} />
        )}
        <RunTable {...{ query, address, listed, experiments, selected }} onSelect={choose} />
        <KnownTags tags={tags} />
        {next && <LoadMore query={listedQuery} />}
      </Page>
    </>
  );
}

function KnownTags({ tags }: { tags: string[] }) {
  return (
    <datalist id={TAGS_ID}>
      {tags.map((tag) => (
        <option key={tag} value={tag} />
      ))}
    </datalist>
  );
}

function HeaderLinks({ bin }: { bin: boolean }) {
  const refusal = useRefusal();
  return (
    <>
      <span class="spring" />
      <a class="button" href={bin ? "/" : "/?deleted=true"}>
        {bin ? text.runs : text.bin}
      </a>
      {!refusal && (
        <a class="button primary" href="/new">
          {text.newRun}
        </a>
      )}
    </>
  );
}

interface CompareProps {
  ids: string[];
  listed: readonly string[];
  onSelect: (ids: string[]) => void;
}

function CompareBar({ ids, listed, onSelect }: CompareProps) {
  const all = [...new Set([...ids, ...listed])];
  return (
    <p class="selected row" role="status">
      <span>
        {text.selected(ids.length)}
        {ids.length === 1 && text.selectAnother}
        {ids.length > MAX_RUNS && text.compareLimit(MAX_RUNS)}
      </span>
      <span class="spring" />
      {ids.length > 1 && ids.length <= MAX_RUNS && (
        <a class="button primary" href={`/compare?runs=${ids.join()}`}>
          {text.compare}
        </a>
      )}
      {all.length > ids.length && all.length <= MAX_RUNS && (
        <button onClick={() => onSelect(all)}>{text.selectAll(listed.length)}</button>
      )}
      <button onClick={() => onSelect([])}>{text.clearSelection}</button>
    </p>
  );
}

function SweepBanner({ sweep }: { sweep: string }) {
  if (sweep === WITHOUT_SWEEP) return null;
  return (
    <p class="banner reason quiet">
      {text.runsOf}
      <a href={`/sweeps/${sweep}`}>{text.oneSweep}</a>
      {text.sweepHint}
    </p>
  );
}

/** A note in place of the list: an empty bin, no matches, or no runs at all. */
function NothingListed({ query }: { query: RunQuery }) {
  if (isFiltered(query)) {
    return (
      <Empty title={text.noMatch} hint={text.noMatchHint}>
        <button onClick={() => setQuery(NO_FILTERS)}>{text.showAllRuns}</button>
      </Empty>
    );
  }
  if (query.deleted) return <p class="quiet">{text.binEmpty}</p>;
  return (
    <Empty title={text.noRuns} hint={text.noRunsHint}>
      <a class="button primary" href="/new">
        {text.startFirst}
      </a>
    </Empty>
  );
}

function Welcome() {
  const demonstration = useStore((state) => [...state.runs.values()].find((run) => run.demonstration));
  if (hasTakenTour() || !demonstration) return null;
  return (
    <p class="banner welcome">
      {text.welcome} <a href={`/runs/${demonstration.id}`}>{text.tour}</a>
    </p>
  );
}

function LoadMore({ query }: { query: RunQuery }) {
  const [busy, setBusy] = useState(false);
  const load = async () => {
    setBusy(true);
    await loadMoreRuns(query).catch(showFailure);
    setBusy(false);
  };
  return (
    <p class="more">
      <button onClick={load} disabled={busy}>
        {busy ? text.loading : text.loadMore}
      </button>
    </p>
  );
}

interface Props {
  page: SweepPage;
  /** Null if all are shown. */
  onMore: (() => void) | null;
}

/** Sweeps above the list of runs, one row for each. */
function SweepRows({ page, onMore }: Props) {
  return (
    <section class="sweep-rows" aria-label={text.sweeps}>
      <ul>
        {page.items.map((sweep) => (
          <li key={sweep.id} class="card sweep-row">
            <span class="sweep-name">
              <a class="run-name" href={`/sweeps/${sweep.id}`}>
                {sweepTitle(sweep)}
              </a>
              <span class="quiet small">
                {sizeText(sweep)} · {dateTime(sweep.created_at)}
              </span>
            </span>
            <span class="sweep-status">
              <SweepProgress sweep={sweep} />
              <SweepStates sweep={sweep} />
            </span>
            <a class="button" href={`/?sweep=${sweep.id}`} aria-label={text.runsOfSweep(sweepTitle(sweep))}>
              {text.runs}
            </a>
          </li>
        ))}
      </ul>
      {page.next && onMore && <button onClick={onMore}>{text.moreSweeps}</button>}
    </section>
  );
}
