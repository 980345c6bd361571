/** What the page knows of the runs, and how each event of the server changes it. */

import type {
  Archive,
  ElitesEvent,
  GenerationEvent,
  Generations,
  ResultsEvent,
  RewindEvent,
  Run,
  RunEvent,
  RunPage,
} from "../api/types";
import {
  type Detail,
  NOTHING,
  cut,
  doubted,
  replaced,
  withChanges,
  withCurvePoint,
} from "./detail";
import { type Pace, rateOf, withEvent, withPoint } from "./pace";

export type Connection = "connecting" | "live" | "lost";

export interface State {
  connection: Connection;
  runs: ReadonlyMap<string, Run>;
  paces: ReadonlyMap<string, Pace>;
  details: ReadonlyMap<string, Detail>;
  /** How often the table of a run has grown since the page was opened. */
  tables: ReadonlyMap<string, number>;
  /** Ids of the listed runs, newest first, and where the list goes on. */
  listed: readonly string[];
  next: string | null;
  /** Raised when what was fetched before is not to be trusted any more. */
  epoch: number;
  /** The same for one run, after a rewind. */
  epochs: ReadonlyMap<string, number>;
}

export type Action =
  | { type: "connection"; connection: Connection }
  | { type: "run"; run: RunEvent }
  | { type: "list"; page: RunPage; more: boolean }
  | { type: "open"; run: string }
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
  | { type: "reset" };

export const EMPTY: State = {
  connection: "connecting",
  runs: new Map(),
  paces: new Map(),
  details: new Map(),
  tables: new Map(),
  listed: [],
  next: null,
  epoch: 0,
  epochs: new Map(),
};

export function reduce(state: State, action: Action): State {
  switch (action.type) {
    case "connection":
      return { ...state, connection: action.connection };
    case "run":
      return withRun(state, action.run);
    case "list":
      return withPage(state, action.page, action.more);
    case "open":
      return opened(state, action.run);
    case "snapshot":
      return withSnapshot(state, action);
    case "generation":
      return withGeneration(state, action.event);
    case "elites":
      return withDetail(state, action.event.run, (detail) => withChanges(detail, action.event));
    case "results":
      return grown(state, action.event);
    case "rewind":
      return rewound(state, action.event);
    case "reset":
      return reset(state);
  }
}

/** Which fetch of a run's detail still counts: it grows with every reset and rewind. */
export function epochOf(state: State, run: string): number {
  return state.epoch + (state.epochs.get(run) ?? 0);
}

function withRun(state: State, event: RunEvent): State {
  const spec = event.spec ?? state.runs.get(event.id)?.spec;
  if (!spec) return state;
  const run = { ...event, spec };
  const known = state.listed.includes(run.id);
  const listed = known ? state.listed : byAge(state.runs, [run, ...state.listed]);
  return { ...state, runs: new Map(state.runs).set(run.id, run), listed };
}

/** Runs that only an event has told of stand in the list too, at their place. */
function byAge(runs: ReadonlyMap<string, Run>, [run, ...ids]: [Run, ...string[]]): string[] {
  const later = ids.filter((id) => (runs.get(id)?.created_at ?? "") > run.created_at);
  return [...later, run.id, ...ids.filter((id) => !later.includes(id))];
}

function withPage(state: State, page: RunPage, more: boolean): State {
  const runs = new Map(state.runs);
  for (const run of page.items) runs.set(run.id, run);
  const ids = page.items.map((run) => run.id);
  const kept = more ? state.listed.filter((id) => !ids.includes(id)) : [];
  return { ...state, runs, listed: [...kept, ...ids], next: page.next };
}

/** From here on events of the run are kept: its snapshot may be older than they are. */
function opened(state: State, run: string): State {
  if (state.details.has(run)) return state;
  return { ...state, details: new Map(state.details).set(run, NOTHING) };
}

function withSnapshot(state: State, action: Action & { type: "snapshot" }): State {
  if (action.epoch !== epochOf(state, action.run)) return state;
  const old = state.details.get(action.run) ?? NOTHING;
  const detail = replaced(old, action.archive, action.generations);
  return { ...state, details: new Map(state.details).set(action.run, detail) };
}

function withGeneration(state: State, event: GenerationEvent): State {
  const next = withDetail(state, event.run, (detail) => withCurvePoint(detail, event));
  const run = state.runs.get(event.run);
  if (!run || event.generation <= run.generation) return next;
  const pace = withEvent(state.paces.get(run.id) ?? [], event);
  return {
    ...next,
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
  return { ...next, runs: new Map(state.runs).set(id, { ...run, summary }) };
}

function rewound(state: State, event: RewindEvent): State {
  const raised = (state.epochs.get(event.run) ?? 0) + 1;
  const next = { ...state, epochs: new Map(state.epochs).set(event.run, raised) };
  const run = state.runs.get(event.run);
  if (run) next.runs = new Map(state.runs).set(run.id, cutRun(run, event.generation));
  return withDetail(next, event.run, (detail) => cut(detail, event.generation));
}

/** A rewind may have been missed: what is known is shown on, but not believed. */
function reset(state: State): State {
  const details = new Map([...state.details].map(([run, detail]) => [run, doubted(detail)]));
  return { ...state, details, epoch: state.epoch + 1 };
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
