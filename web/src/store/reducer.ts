/** What the page knows of the runs, and how each event of the server changes it. */

import type {
  Archive,
  Caller,
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
import { type Detail, NOTHING, cut, doubted, replaced, withChanges, withCurvePoint } from "./detail";
import { type Watching, cutWatched, doubtedWatched, watched, withHistory, withNext } from "./watched";
import { type Pace, rateOf, withEvent, withPoint } from "./rate";
import { answered, done, heardOf, said, told } from "./reconcile";

export type Connection = "connecting" | "live" | "lost";

export interface State {
  connection: Connection;
  /** Who the server takes us for; null until it says so. */
  caller: Caller | null;
  runs: ReadonlyMap<string, Run>;
  paces: ReadonlyMap<string, Pace>;
  details: ReadonlyMap<string, Detail>;
  watching: Watching;
  /** How often the table of a run has grown since the page was opened. */
  tables: ReadonlyMap<string, number>;
  /** How often something was heard of a sweep or of one of its runs. */
  swept: ReadonlyMap<string, number>;
  /** Which runs were asked for; their ids in their order, and where the list goes on. */
  asked: string;
  listed: readonly string[];
  next: string | null;
  /** How often something was heard of runs, when the last time of each, and of all at once. */
  heard: number;
  last: ReadonlyMap<string, number>;
  trusted: number;
  /** How runs stand of which it is not known yet what they are. */
  early: ReadonlyMap<string, RunEvent>;
  /** Raised by news that may change which runs belong to a list, or in which order. */
  news: number;
  /** Raised when what was fetched before is not to be trusted any more. */
  epoch: number;
  /** The same for one run, after a rewind. */
  epochs: ReadonlyMap<string, number>;
}

export type Action =
  | { type: "connection"; connection: Connection }
  | { type: "caller"; caller: Caller }
  | { type: "run"; run: RunEvent }
  | { type: "answer"; run: Run; sent: number }
  | { type: "done"; run: Run; sent: number }
  | { type: "said"; run: string; change: RunChange }
  | ({ type: "list" } & Listing)
  | ({ type: "more" } & Further)
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
interface Listing {
  asked: string;
  page: RunPage;
  known: number;
  sent: number;
}

/** What follows in a list after a place in it. */
interface Further {
  asked: string;
  page: RunPage;
  cursor: string | null;
  sent: number;
}

export const EMPTY: State = {
  connection: "connecting",
  caller: null,
  runs: new Map(),
  paces: new Map(),
  details: new Map(),
  watching: new Map(),
  tables: new Map(),
  swept: new Map(),
  asked: "",
  listed: [],
  next: null,
  heard: 0,
  last: new Map(),
  trusted: 0,
  early: new Map(),
  news: 0,
  epoch: 0,
  epochs: new Map(),
};

export function reduce(state: State, action: Action): State {
  switch (action.type) {
    case "connection":
      return { ...state, connection: action.connection };
    case "caller":
      return { ...state, caller: action.caller };
    case "run":
      return told(sweptOf(state, action.run.sweep), action.run);
    case "answer":
      return answered(state, [action.run], action.sent);
    case "done":
      return done(state, action.run, action.sent);
    case "said":
      return said(state, action.run, action.change);
    case "list":
      return listed(state, action);
    case "more":
      return withMore(state, action);
    case "open":
      return opened(state, action.run, action.more);
    case "snapshot":
      return withSnapshot(state, action);
    case "watch":
      return { ...state, watching: watched(state.watching, action.run, action.more) };
    case "curves":
      return withCurves(state, action);
    case "generation":
      return withGeneration(state, action.event);
    case "elites":
      return withDetail(state, action.event.run, (detail) => withChanges(detail, action.event));
    case "results":
      return grown(state, action.event);
    case "rewind":
      return rewound(state, action.event);
    case "sweep":
      return { ...sweptOf(state, action.sweep), news: state.news + 1 };
    case "purge":
      return purged(state, action.run);
    case "reset":
      return reset(state);
  }
}

/** A sweep is summed up by the server: it is asked for anew when there is news of it. */
function sweptOf(state: State, sweep?: string | null): State {
  if (!sweep) return state;
  return { ...state, swept: new Map(state.swept).set(sweep, (state.swept.get(sweep) ?? 0) + 1) };
}

/** Which fetch of a run's detail still counts: it grows with every reset and rewind. */
export function epochOf(state: State, run: string): number {
  return state.epoch + (state.epochs.get(run) ?? 0);
}

/** Only the server says which runs a list has: an event alone puts none into it. */
function listed(state: State, { asked, page, known, sent }: Listing): State {
  const next = answered(state, page.items, sent);
  const grown = asked === state.asked && state.listed.length > known;
  // What was loaded meanwhile is not in the answer.
  if (grown) return { ...next, news: state.news + 1 };
  return { ...next, asked, listed: page.items.map((run) => run.id), next: page.next };
}

function withMore(state: State, { asked, page, cursor, sent }: Further): State {
  if (asked !== state.asked) return state;
  const ids = page.items.map((run) => run.id);
  const listed = [...state.listed.filter((id) => !ids.includes(id)), ...ids];
  // The list may end elsewhere now, so that something between is missing.
  const news = state.news + Number(cursor !== state.next);
  return { ...answered(state, page.items, sent), news, listed, next: page.next };
}

/**
 * One more looks at a run, or one less. While somebody does, its events are kept, for its
 * snapshot may be older than they are.
 */
function opened(state: State, run: string, more: 1 | -1): State {
  const old = state.details.get(run) ?? NOTHING;
  const details = new Map(state.details).set(run, { ...old, watchers: old.watchers + more });
  if (details.get(run)!.watchers <= 0) details.delete(run);
  return { ...state, details };
}

function withSnapshot(state: State, action: Action & { type: "snapshot" }): State {
  const { run, epoch, archive, generations } = action;
  if (epoch !== epochOf(state, run)) return state;
  return withDetail(state, run, (old) => replaced(old, archive, generations));
}

function withCurves(state: State, action: Action & { type: "curves" }): State {
  if (action.epoch !== epochOf(state, action.run)) return state;
  return { ...state, watching: withHistory(state.watching, action.run, action.generations) };
}

function withGeneration(state: State, event: GenerationEvent): State {
  const opened = withDetail(state, event.run, (detail) => withCurvePoint(detail, event));
  const next = { ...opened, watching: withNext(opened.watching, event) };
  const run = state.runs.get(event.run);
  if (!run || event.generation <= run.generation) return next;
  const pace = withEvent(state.paces.get(run.id) ?? [], event);
  return {
    ...heardOf(next, run.id),
    paces: new Map(next.paces).set(run.id, pace),
    runs: new Map(next.runs).set(run.id, advanced(run, event, pace)),
  };
}

function advanced(run: Run, event: GenerationEvent, pace: Pace): Run {
  const { generation, qd_score, coverage, best, evaluations, diverged } = event;
  const newer = { generation, qd_score, coverage, best, evaluations, diverged };
  const progress = Math.min(1, generation / run.generations);
  const sparkline = withPoint(run.sparkline, run.generation, qd_score, generation);
  return { ...run, ...newer, progress, sparkline, ...rateOf(pace, run) };
}

/** Tables are short: they are fetched anew rather than put together of events. */
function grown(state: State, { run: id, generation, summary }: ResultsEvent): State {
  const count = (state.tables.get(id) ?? 0) + 1;
  const next = { ...state, tables: new Map(state.tables).set(id, count) };
  const run = state.runs.get(id);
  if (!run || !summary || generation < run.generation) return next;
  return { ...heardOf(next, id), runs: new Map(state.runs).set(id, { ...run, summary }) };
}

function rewound(state: State, event: RewindEvent): State {
  const raised = (state.epochs.get(event.run) ?? 0) + 1;
  const run = state.runs.get(event.run);
  const next = {
    ...(run ? heardOf(state, run.id) : state),
    epochs: new Map(state.epochs).set(event.run, raised),
    watching: cutWatched(state.watching, event.run, event.generation),
  };
  if (run) next.runs = new Map(state.runs).set(run.id, cutRun(run, event.generation));
  return withDetail(next, event.run, (detail) => cut(detail, event.generation));
}

/** Gone for good: no list has it, and whoever looks at it asks again and is told so. */
function purged(state: State, id: string): State {
  const sweep = state.runs.get(id)?.sweep;
  const runs = new Map(state.runs);
  runs.delete(id);
  return {
    ...sweptOf(heardOf(state, id), sweep),
    runs,
    listed: state.listed.filter((listed) => listed !== id),
    epochs: new Map(state.epochs).set(id, (state.epochs.get(id) ?? 0) + 1),
    news: state.news + 1,
  };
}

/** A rewind may have been missed: what is known is shown on, but not believed. */
function reset(state: State): State {
  const details = new Map([...state.details].map(([run, detail]) => [run, doubted(detail)]));
  const watching = doubtedWatched(state.watching);
  const heard = state.heard + 1;
  const unheard = { heard, trusted: heard, early: new Map() };
  return { ...state, ...unheard, details, watching, epoch: state.epoch + 1 };
}

/** A run that goes on from an earlier generation; its figures follow with the next one. */
function cutRun(run: Run, generation: number): Run {
  if (run.generation <= generation) return run;
  const kept = Math.ceil((run.sparkline.length * generation) / run.generation);
  const progress = generation / run.generations;
  return { ...run, generation, progress, sparkline: run.sparkline.slice(0, kept) };
}

/** Changes a detail that is open; events of runs that nobody looks at are not kept. */
function withDetail(state: State, run: string, change: (detail: Detail) => Detail): State {
  const detail = state.details.get(run);
  if (!detail) return state;
  return { ...state, details: new Map(state.details).set(run, change(detail)) };
}
