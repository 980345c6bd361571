/** What the page knows of the runs, and how each event of the server changes it. */

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
import * as watched from "./watched";
import { withPoint } from "./sparkline";
import { applyResponses, applyChange, noteEvent, applyEdit, applyEvent } from "./reconcile";

export type Connection = "connecting" | "live" | "lost";

export interface State {
  connection: Connection;
  /** Who the server takes us for; null until it says so. */
  principal: Principal | null;
  runs: ReadonlyMap<string, Run>;
  details: ReadonlyMap<string, details.Detail>;
  watching: watched.Watching;
  /** How often the table of a run has grown since the page was opened. */
  tableVersions: ReadonlyMap<string, number>;
  /** How often something was heard of a sweep or of one of its runs. */
  sweepVersions: ReadonlyMap<string, number>;
  /** Which runs were asked for; their ids in their order, and where the list goes on. */
  asked: string;
  listed: readonly string[];
  next: string | null;
  /** How often something was heard of runs, when the last time of each, and of all at once. */
  eventCount: number;
  lastEvent: ReadonlyMap<string, number>;
  trustedSince: number;
  /** How runs stand of which it is not known yet what they are. */
  eventsWithoutSpec: ReadonlyMap<string, RunEvent>;
  /** Raised by news that may change which runs belong to a list, or in which order. */
  listVersion: number;
  /** Raised when what was fetched before is not to be trusted any more. */
  epoch: number;
  /** The same for one run, after a rewind. */
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
  | { type: "watch"; run: string; more: 1 | -1 }
  | { type: "curves"; run: string; epoch: number; generations: Generations }
  | { type: "generation"; event: GenerationEvent }
  | { type: "elites"; event: ElitesEvent }
  | { type: "results"; event: ResultsEvent }
  | { type: "rewind"; event: RewindEvent }
  | { type: "sweep"; sweep: string }
  | { type: "purge"; run: string }
  | { type: "reset" };

/** A list from its beginning, asked for when so many runs of it were known. */
interface FirstPage {
  asked: string;
  page: RunPage;
  known: number;
  sent: number;
}

/** What follows in a list after a place in it. */
interface NextPage {
  asked: string;
  page: RunPage;
  cursor: string | null;
  sent: number;
}

export const INITIAL_STATE: State = {
  connection: "connecting",
  principal: null,
  runs: new Map(),
  details: new Map(),
  watching: new Map(),
  tableVersions: new Map(),
  sweepVersions: new Map(),
  asked: "",
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
    case "watch":
      return { ...state, watching: watched.changeWatchers(state.watching, action.run, action.more) };
    case "curves":
      return withCurves(state, action);
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

/** A sweep is summed up by the server: it is asked for anew when there is news of it. */
function raiseSweepVersion(state: State, sweep?: string | null): State {
  if (!sweep) return state;
  return {
    ...state,
    sweepVersions: new Map(state.sweepVersions).set(sweep, (state.sweepVersions.get(sweep) ?? 0) + 1),
  };
}

/** Which fetch of a run's detail still counts: it grows with every reset and rewind. */
export function epochOf(state: State, run: string): number {
  return state.epoch + (state.epochs.get(run) ?? 0);
}

/** Only the server says which runs a list has: an event alone puts none into it. */
function listed(state: State, { asked, page, known, sent }: FirstPage): State {
  const next = applyResponses(state, page.items, sent);
  const withResults = asked === state.asked && state.listed.length > known;
  // What was loaded meanwhile is not in the answer.
  if (withResults) return { ...next, listVersion: state.listVersion + 1 };
  return { ...next, asked, listed: page.items.map((run) => run.id), next: page.next };
}

function withMore(state: State, { asked, page, cursor, sent }: NextPage): State {
  if (asked !== state.asked) return state;
  const ids = page.items.map((run) => run.id);
  const listed = [...state.listed.filter((id) => !ids.includes(id)), ...ids];
  // The list may end elsewhere now, so that something between is missing.
  const listVersion = state.listVersion + Number(cursor !== state.next);
  return { ...applyResponses(state, page.items, sent), listVersion, listed, next: page.next };
}

/**
 * One more looks at a run, or one less. While somebody does, its events are kept, for its
 * snapshot may be older than they are.
 */
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

function withCurves(state: State, action: Action & { type: "curves" }): State {
  if (action.epoch !== epochOf(state, action.run)) return state;
  return { ...state, watching: watched.withCurves(state.watching, action.run, action.generations) };
}

function withGeneration(state: State, event: GenerationEvent): State {
  const opened = withDetail(state, event.run, (detail) => details.withGenerationEvent(detail, event));
  const next = { ...opened, watching: watched.withGenerationEvent(opened.watching, event) };
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

/** Tables are short: they are fetched anew rather than put together of events. */
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
    watching: watched.truncate(state.watching, event.run, event.generation),
  };
  if (run) next.runs = new Map(state.runs).set(run.id, truncateRun(run, event.generation));
  return withDetail(next, event.run, (detail) => details.truncate(detail, event.generation));
}

/** Gone for good: no list has it, and whoever looks at it asks again and is told so. */
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

/** A rewind may have been missed: what is known is shown on, but not believed. */
function reset(state: State): State {
  const opened = new Map([...state.details].map(([run, detail]) => [run, details.withoutRecent(detail)]));
  const watching = watched.withoutRecent(state.watching);
  const eventCount = state.eventCount + 1;
  return {
    ...state,
    eventCount,
    trustedSince: eventCount,
    eventsWithoutSpec: new Map(),
    details: opened,
    watching,
    epoch: state.epoch + 1,
  };
}

/** A run that goes on from an earlier generation; its figures follow with the next one. */
function truncateRun(run: Run, generation: number): Run {
  if (run.generation <= generation) return run;
  const kept = Math.ceil((run.sparkline.length * generation) / run.generation);
  const progress = generation / run.generations;
  return { ...run, generation, progress, sparkline: run.sparkline.slice(0, kept) };
}

/** Changes a detail that is open; events of runs that nobody looks at are not kept. */
function withDetail(state: State, run: string, change: (detail: details.Detail) => details.Detail): State {
  const detail = state.details.get(run);
  if (!detail) return state;
  return { ...state, details: new Map(state.details).set(run, change(detail)) };
}
