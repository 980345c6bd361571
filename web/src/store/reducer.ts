/** The state of the page, and how each action changes it. */

import type {
  Archive,
  Principal,
  ElitesEvent,
  GenerationEvent,
  Generations,
  ResultsEvent,
  RewindEvent,
  Run,
  RunChange,
  RunEvent,
  RunPage,
} from "../api/types";
import * as details from "./detail";
import { withPoint } from "./curves";
import { applyResponses, applyChange, noteEvent, applyEdit, applyEvent } from "./reconcile";

export type Connection = "connecting" | "live" | "lost";

export interface State {
  connection: Connection;
  /** The signed-in principal; null until it is loaded. */
  principal: Principal | null;
  runs: ReadonlyMap<string, Run>;
  details: ReadonlyMap<string, details.Detail>;
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
  trustedSince: number;
  /** The last event of each run whose spec is unknown. */
  eventsWithoutSpec: ReadonlyMap<string, RunEvent>;
  /** Increases if the members or the order of the list may have changed. */
  listVersion: number;
  /** Increases if everything has to be fetched again. */
  epoch: number;
  /** The same for each run, after a rewind. */
  epochs: ReadonlyMap<string, number>;
}

export type Action =
  | { type: "connection"; connection: Connection }
  | { type: "principal"; principal: Principal }
  | { type: "run"; run: RunEvent }
  | { type: "response"; run: Run; sent: number }
  | { type: "change"; run: Run; sent: number }
  | { type: "edit"; run: string; change: RunChange }
  | ({ type: "list" } & FirstPage)
  | ({ type: "more" } & NextPage)
  | { type: "open"; run: string; more: 1 | -1 }
  | {
      type: "snapshot";
      run: string;
      epoch: number;
      archive: Archive | null;
      generations: Generations;
    }
  | { type: "generation"; event: GenerationEvent }
  | { type: "elites"; event: ElitesEvent }
  | { type: "results"; event: ResultsEvent }
  | { type: "rewind"; event: RewindEvent }
  | { type: "sweep"; sweep: string }
  | { type: "purge"; run: string }
  | { type: "reset" };

/** The start of a list, requested when `known` of its runs were loaded. */
interface FirstPage {
  query: string;
  page: RunPage;
  known: number;
  sent: number;
}

/** The part of a list after a cursor. */
interface NextPage {
  query: string;
  page: RunPage;
  cursor: string | null;
  sent: number;
}

export const INITIAL_STATE: State = {
  connection: "connecting",
  principal: null,
  runs: new Map(),
  details: new Map(),
  tableVersions: new Map(),
  sweepVersions: new Map(),
  query: "",
  listed: [],
  next: null,
  eventCount: 0,
  lastEvent: new Map(),
  trustedSince: 0,
  eventsWithoutSpec: new Map(),
  listVersion: 0,
  epoch: 0,
  epochs: new Map(),
};

export function reduce(state: State, action: Action): State {
  switch (action.type) {
    case "connection":
      return { ...state, connection: action.connection };
    case "principal":
      return { ...state, principal: action.principal };
    case "run":
      return applyEvent(raiseSweepVersion(state, action.run.sweep), action.run);
    case "response":
      return applyResponses(state, [action.run], action.sent);
    case "change":
      return applyChange(state, action.run, action.sent);
    case "edit":
      return applyEdit(state, action.run, action.change);
    case "list":
      return listed(state, action);
    case "more":
      return withMore(state, action);
    case "open":
      return withWatcher(state, action.run, action.more);
    case "snapshot":
      return withSnapshot(state, action);
    case "generation":
      return withGeneration(state, action.event);
    case "elites":
      return withDetail(state, action.event.run, (detail) => details.withElitesEvent(detail, action.event));
    case "results":
      return withResults(state, action.event);
    case "rewind":
      return rewindRun(state, action.event);
    case "sweep":
      return { ...raiseSweepVersion(state, action.sweep), listVersion: state.listVersion + 1 };
    case "purge":
      return withoutRun(state, action.run);
    case "reset":
      return reset(state);
  }
}

/** The server summarises a sweep: the page fetches it again when this version changes. */
function raiseSweepVersion(state: State, sweep?: string | null): State {
  if (!sweep) return state;
  return {
    ...state,
    sweepVersions: new Map(state.sweepVersions).set(sweep, (state.sweepVersions.get(sweep) ?? 0) + 1),
  };
}

/** The version of a run's detail; it increases with every reset and rewind. */
export function epochOf(state: State, run: string): number {
  return state.epoch + (state.epochs.get(run) ?? 0);
}

/** Only an answer of the server changes which runs a list has. */
function listed(state: State, { query, page, known, sent }: FirstPage): State {
  const next = applyResponses(state, page.items, sent);
  const extended = query === state.query && state.listed.length > known;
  // More pages were loaded since the request.
  if (extended) return { ...next, listVersion: state.listVersion + 1 };
  return { ...next, query, listed: page.items.map((run) => run.id), next: page.next };
}

function withMore(state: State, { query, page, cursor, sent }: NextPage): State {
  if (query !== state.query) return state;
  const ids = page.items.map((run) => run.id);
  const listed = [...state.listed.filter((id) => !ids.includes(id)), ...ids];
  // If the list ended elsewhere by now, runs may be missing.
  const listVersion = state.listVersion + Number(cursor !== state.next);
  return { ...applyResponses(state, page.items, sent), listVersion, listed, next: page.next };
}

/** Add or remove a viewer of a run; its events are kept while it has one. */
function withWatcher(state: State, run: string, more: 1 | -1): State {
  const old = state.details.get(run) ?? details.EMPTY_DETAIL;
  const opened = new Map(state.details).set(run, { ...old, watchers: old.watchers + more });
  if (opened.get(run)!.watchers <= 0) opened.delete(run);
  return { ...state, details: opened };
}

function withSnapshot(state: State, action: Action & { type: "snapshot" }): State {
  const { run, epoch, archive, generations } = action;
  if (epoch !== epochOf(state, run)) return state;
  return withDetail(state, run, (old) => details.withSnapshot(old, archive, generations));
}

function withGeneration(state: State, event: GenerationEvent): State {
  const next = withDetail(state, event.run, (detail) => details.withGenerationEvent(detail, event));
  const run = state.runs.get(event.run);
  if (!run || event.generation <= run.generation) return next;
  return {
    ...noteEvent(next, run.id),
    runs: new Map(next.runs).set(run.id, withGenerationFigures(run, event)),
  };
}

function withGenerationFigures(run: Run, event: GenerationEvent): Run {
  const { generation, qd_score, coverage, best, evaluations, diverged } = event;
  const newer = { generation, qd_score, coverage, best, evaluations, diverged };
  const progress = Math.min(1, generation / run.generations);
  const sparkline = withPoint(run.sparkline, run.generation, qd_score, generation);
  return { ...run, ...newer, progress, sparkline };
}

/** Tables are short: they are fetched again rather than built from events. */
function withResults(state: State, { run: id, generation, summary }: ResultsEvent): State {
  const count = (state.tableVersions.get(id) ?? 0) + 1;
  const next = { ...state, tableVersions: new Map(state.tableVersions).set(id, count) };
  const run = state.runs.get(id);
  if (!run || !summary || generation < run.generation) return next;
  return { ...noteEvent(next, id), runs: new Map(state.runs).set(id, { ...run, summary }) };
}

function rewindRun(state: State, event: RewindEvent): State {
  const raised = (state.epochs.get(event.run) ?? 0) + 1;
  const run = state.runs.get(event.run);
  const next = {
    ...(run ? noteEvent(state, run.id) : state),
    epochs: new Map(state.epochs).set(event.run, raised),
  };
  if (run) next.runs = new Map(state.runs).set(run.id, truncateRun(run, event.generation));
  return withDetail(next, event.run, (detail) => details.truncate(detail, event.generation));
}

/** Remove a purged run; its page fetches it again and shows the error. */
function withoutRun(state: State, id: string): State {
  const sweep = state.runs.get(id)?.sweep;
  const runs = new Map(state.runs);
  runs.delete(id);
  return {
    ...raiseSweepVersion(noteEvent(state, id), sweep),
    runs,
    listed: state.listed.filter((listed) => listed !== id),
    epochs: new Map(state.epochs).set(id, (state.epochs.get(id) ?? 0) + 1),
    listVersion: state.listVersion + 1,
  };
}

/** Events may have been missed: old data stays visible and is fetched again. */
function reset(state: State): State {
  const opened = new Map([...state.details].map(([run, detail]) => [run, details.withoutRecent(detail)]));
  const eventCount = state.eventCount + 1;
  return {
    ...state,
    eventCount,
    trustedSince: eventCount,
    eventsWithoutSpec: new Map(),
    details: opened,
    epoch: state.epoch + 1,
  };
}

/** A run that continues from an earlier generation; its other figures follow with the next event. */
function truncateRun(run: Run, generation: number): Run {
  if (run.generation <= generation) return run;
  const kept = Math.ceil((run.sparkline.length * generation) / run.generation);
  const progress = generation / run.generations;
  return { ...run, generation, progress, sparkline: run.sparkline.slice(0, kept) };
}

/** Change the detail of a run that is shown; others have none. */
function withDetail(state: State, run: string, change: (detail: details.Detail) => details.Detail): State {
  const detail = state.details.get(run);
  if (!detail) return state;
  return { ...state, details: new Map(state.details).set(run, change(detail)) };
}
