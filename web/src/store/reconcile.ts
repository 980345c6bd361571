/** How runs stand: what events told goes before an answer to what was asked before them. */

import type { Run, RunChange, RunEvent } from "../api/types";
import type { State } from "./reducer";

/** Something was heard of a run, beside which answers on their way are old. */
export function heardOf(state: State, id: string): State {
  const heard = state.heard + 1;
  return { ...state, heard, last: new Map(state.last).set(id, heard) };
}

export function told(state: State, event: RunEvent): State {
  const next = heardOf(state, event.id);
  const known = state.runs.get(event.id);
  const spec = known?.spec ?? event.spec;
  if (!spec) return { ...next, early: new Map(state.early).set(event.id, event) };
  const run = { ...event, spec };
  const news = state.news + Number(!known || DECISIVE.some((name) => differ(run[name], known[name])));
  return { ...next, news, runs: new Map(state.runs).set(run.id, run) };
}

/** What decides whether a run belongs to a list, or why it waits; its figures come by the second. */
const DECISIVE = ["status", "name", "tags", "note", "deleted_at"] as const;

const differ = (one: unknown, other: unknown) => JSON.stringify(one) !== JSON.stringify(other);

/** Answers to what was asked when so many events had been heard. */
export function answered(state: State, answers: readonly Run[], sent: number): State {
  const [runs, last, early] = [new Map(state.runs), new Map(state.last), new Map(state.early)];
  for (const answer of answers) {
    runs.set(answer.id, believed(state, answer, sent));
    last.set(answer.id, Math.max(sent, last.get(answer.id) ?? 0));
    early.delete(answer.id);
  }
  return { ...state, runs, last, early };
}

/** What a run is never changes: its spec stays the same object. */
function believed(state: State, answer: Run, sent: number): Run {
  const known = state.runs.get(answer.id);
  const late = sent < Math.max(state.last.get(answer.id) ?? 0, state.trusted);
  if (!late) return { ...answer, spec: known?.spec ?? answer.spec };
  return known ?? { ...answer, ...state.early.get(answer.id), spec: answer.spec };
}

/** The answer to a change that was asked for here: which runs a list has may be another now. */
export function done(state: State, answer: Run, sent: number): State {
  const next = heardOf(answered(state, [answer], sent), answer.id);
  return { ...next, news: state.news + 1 };
}

/** What the server has yet to hear: lists are asked for when it has. */
export function said(state: State, id: string, change: RunChange): State {
  const run = state.runs.get(id);
  if (!run) return state;
  return { ...heardOf(state, id), runs: new Map(state.runs).set(id, { ...run, ...change }) };
}
