/** The state of the page, and the functions that change it. */

import type * as wire from "../api/types";
import * as details from "./detail";
import { withPoint } from "./curves";
import type { Toast } from "./toasts";
import { applyEvent, applyResponses, countEvent, raised } from "./reconcile";

export type Connection = "connecting" | "live" | "lost";

export interface State {
  connection: Connection;
  toasts: readonly Toast[];
  /** The signed-in principal; null until it is loaded. */
  principal: wire.Principal | null;
  runs: ReadonlyMap<string, wire.Run>;
  details: ReadonlyMap<string, details.Detail>;
  /** The chosen creatures of each run that was shown. */
  choices: ReadonlyMap<string, wire.Choices>;
  /** Counts changes of the results table of each run. */
  tableVersions: ReadonlyMap<string, number>;
  /** Counts events of each sweep and its runs. */
  sweepVersions: ReadonlyMap<string, number>;
  /** The query of the list of runs, the ids in it, and the cursor of its next page. */
  query: string;
  listed: readonly string[];
  next: string | null;
  /** Counts events; the counts at the last event of each run and at the last reset. */
  eventCount: number;
  lastEvent: ReadonlyMap<string, number>;
  lastReset: number;
  /** The last event of each run whose spec is unknown. */
  eventsWithoutSpec: ReadonlyMap<string, wire.RunEvent>;
  /** Increases if the members or the order of the list may have changed. */
  listVersion: number;
  /** Increases if everything has to be fetched again. */
  epoch: number;
  /** The same for each run, after a rewind, or after an extension that left its spec out. */
  epochs: ReadonlyMap<string, number>;
}

export const INITIAL_STATE: State = {
  connection: "connecting",
  toasts: [],
  principal: null,
  runs: new Map(),
  details: new Map(),
  choices: new Map(),
  tableVersions: new Map(),
  sweepVersions: new Map(),
  query: "",
  listed: [],
  next: null,
  eventCount: 0,
  lastEvent: new Map(),
  lastReset: 0,
  eventsWithoutSpec: new Map(),
  listVersion: 0,
  epoch: 0,
  epochs: new Map(),
};

/** The version of a run's detail; it increases with every reset and rewind. */
export const epochOf = ({ epoch, epochs }: State, run: string): number => epoch + (epochs.get(run) ?? 0);

export const withRunEvent = (state: State, run: wire.RunEvent): State =>
  applyEvent(raiseSweepVersion(state, run.sweep), run);

export const withSweepEvent = (state: State, { sweep }: { sweep: string }): State => ({
  ...raiseSweepVersion(state, sweep),
  listVersion: state.listVersion + 1,
});

/** The server summarises a sweep: the page fetches it again when this version changes. */
function raiseSweepVersion(state: State, sweep?: string | null): State {
  return sweep ? { ...state, sweepVersions: raised(state.sweepVersions, sweep) } : state;
}

interface Answer {
  query: string;
  page: wire.RunPage;
  /** The event count at the request. */
  sentAt: number;
}

/** The start of a list, requested when `known` of its runs were loaded; no event changes which runs a list has. */
export function withList(state: State, { query, page, known, sentAt }: Answer & { known: number }): State {
  const next = applyResponses(state, page.items, sentAt);
  const extended = query === state.query && state.listed.length > known;
  // More pages were loaded since the request.
  if (extended) return { ...next, listVersion: state.listVersion + 1 };
  return { ...next, query, listed: page.items.map((run) => run.id), next: page.next };
}

export function withMore(
  state: State,
  { query, page, cursor, sentAt }: Answer & { cursor: string | null },
): State {
  if (query !== state.query) return state;
  const ids = page.items.map((run) => run.id);
  const listed = [...state.listed.filter((id) => !ids.includes(id)), ...ids];
  // If the list ended elsewhere by now, runs may be missing.
  const listVersion = state.listVersion + Number(cursor !== state.next);
  return { ...applyResponses(state, page.items, sentAt), listVersion, listed, next: page.next };
}

/** Add or remove a viewer of a run; its detail exists while it has one. */
export function withViewer(state: State, run: string, more: 1 | -1): State {
  const old = state.details.get(run) ?? details.EMPTY_DETAIL;
  const opened = new Map(state.details).set(run, { ...old, viewers: old.viewers + more });
  if (opened.get(run)!.viewers <= 0) opened.delete(run);
  return { ...state, details: opened };
}

/** `epoch` is the version of the run's detail before the request. */
export function withSnapshot(
  state: State,
  run: string,
  epoch: number,
  archive: wire.Archive | null,
  generations: wire.Generations,
): State {
  if (epoch !== epochOf(state, run)) return state;
  return withDetail(state, run, (old) => details.withSnapshot(old, archive, generations));
}

export const withElitesEvent = (state: State, event: wire.ElitesEvent): State =>
  withDetail(state, event.run, (detail) => details.withElitesEvent(detail, event));

/** Figures that a run keeps until its elites are re-evaluated again. */
const CORRECTED = ["corrected_qd_score", "corrected_coverage", "hit_rate"] as const;

const pick = (summary: wire.Values, names: readonly string[]) =>
  Object.fromEntries(names.filter((name) => name in summary).map((name) => [name, summary[name]]));

export function withGenerationEvent(state: State, event: wire.GenerationEvent): State {
  const next = withDetail(state, event.run, (detail) => details.withGenerationEvent(detail, event));
  const run = state.runs.get(event.run);
  if (!run || event.generation <= run.generation) return next;
  const { generation, qd_score, coverage, best, evaluations, infeasible } = event;
  const corrected = pick(event.summary ?? {}, CORRECTED);
  const figures = { generation, qd_score, coverage, best, evaluations, infeasible, ...corrected };
  const progress = Math.min(1, generation / run.generations);
  const sparkline = withPoint(run.sparkline, run.generation, qd_score, generation);
  return withRun(next, { ...run, ...figures, progress, sparkline });
}

/** Tables are short: they are fetched again rather than built from events. */
export function withResultsEvent(state: State, { run: id, generation, summary }: wire.ResultsEvent): State {
  const next = { ...state, tableVersions: raised(state.tableVersions, id) };
  const run = state.runs.get(id);
  if (!run || !summary || generation < run.generation) return next;
  return withRun(next, { ...run, summary });
}

/** The run continues from an earlier generation; its other figures follow with the next event. */
export function withRewind(state: State, { run: id, generation }: wire.RewindEvent): State {
  const run = state.runs.get(id);
  const next = { ...state, epochs: raised(state.epochs, id) };
  const rewound = run ? withRun(next, truncateRun(run, generation)) : next;
  return withDetail(rewound, id, (detail) => details.truncate(detail, generation));
}

function truncateRun(run: wire.Run, generation: number): wire.Run {
  if (run.generation <= generation) return run;
  const points = Math.ceil((run.sparkline.length * generation) / run.generation);
  const progress = generation / run.generations;
  return { ...run, generation, progress, sparkline: run.sparkline.slice(0, points) };
}

/** Remove a purged run; its page fetches it again and shows the error. */
export function withoutRun(state: State, { run: id }: { run: string }): State {
  const runs = new Map(state.runs);
  runs.delete(id);
  return {
    ...raiseSweepVersion(countEvent(state, id), state.runs.get(id)?.sweep),
    runs,
    listed: state.listed.filter((listed) => listed !== id),
    epochs: raised(state.epochs, id),
    listVersion: state.listVersion + 1,
  };
}

/** Events may have been missed: old data stays visible and is fetched again. */
export function reset(state: State): State {
  const eventCount = state.eventCount + 1;
  return {
    ...state,
    eventCount,
    lastReset: eventCount,
    eventsWithoutSpec: new Map(),
    details: new Map([...state.details].map(([run, detail]) => [run, details.withoutRecent(detail)])),
    epoch: state.epoch + 1,
  };
}

/** The state with figures of a run from an event. */
const withRun = (state: State, run: wire.Run): State => ({
  ...countEvent(state, run.id),
  runs: new Map(state.runs).set(run.id, run),
});

/** Change the detail of a run that is shown; others have none. */
function withDetail(state: State, run: string, change: (detail: details.Detail) => details.Detail): State {
  const detail = state.details.get(run);
  if (!detail) return state;
  return { ...state, details: new Map(state.details).set(run, change(detail)) };
}
