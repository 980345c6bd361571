/** Merge events and answers about runs; an event wins over an answer requested before it. */

import type { Run, RunChange, RunEvent } from "../api/types";
import type { State } from "./state";

/** Count an event of a run; answers that were requested before it are late. */
export function countEvent(state: State, id: string): State {
  const eventCount = state.eventCount + 1;
  return { ...state, eventCount, lastEvent: new Map(state.lastEvent).set(id, eventCount) };
}

export function applyEvent(state: State, event: RunEvent): State {
  const next = countEvent(state, event.id);
  const known = state.runs.get(event.id);
  const spec = newest(known?.spec, event.spec);
  // Lists ask for the spec of a run that they do not know: events carry no long ones.
  const before = known ?? state.eventsWithoutSpec.get(event.id);
  const listVersion =
    state.listVersion + Number(!before || LIST_FIELDS.some((name) => isDifferent(event[name], before[name])));
  if (!spec) {
    const eventsWithoutSpec = new Map(state.eventsWithoutSpec).set(event.id, event);
    return { ...next, listVersion, eventsWithoutSpec };
  }
  const runs = new Map(state.runs).set(event.id, { ...event, spec });
  const isExtended = !event.spec && known!.generations !== event.generations;
  // An extension changes the spec: the run is fetched again if it is shown.
  return { ...next, listVersion, runs, epochs: isExtended ? raised(state.epochs, event.id) : state.epochs };
}

/** The counters with one more for an id. */
export const raised = (counts: ReadonlyMap<string, number>, id: string) =>
  new Map(counts).set(id, (counts.get(id) ?? 0) + 1);

/** Fields that decide whether a run belongs to a list. */
const LIST_FIELDS = ["status", "name", "tags", "note", "deleted_at"] as const;

const isDifferent = (one: unknown, other: unknown) => JSON.stringify(one) !== JSON.stringify(other);

/** Apply answers that were requested at the event count `sentAt`. */
export function applyResponses(state: State, answers: readonly Run[], sentAt: number): State {
  const [runs, lastEvent] = [new Map(state.runs), new Map(state.lastEvent)];
  const eventsWithoutSpec = new Map(state.eventsWithoutSpec);
  for (const answer of answers) {
    runs.set(answer.id, newerOf(state, answer, sentAt));
    lastEvent.set(answer.id, Math.max(sentAt, lastEvent.get(answer.id) ?? 0));
    eventsWithoutSpec.delete(answer.id);
  }
  return { ...state, runs, lastEvent, eventsWithoutSpec };
}

/** The newer spec: an extension changes it. An equal one stays the same object. */
function newest<Came extends Run["spec"] | undefined>(known: Run["spec"] | undefined, came: Came) {
  return known && (came === undefined || !isDifferent(known, came)) ? known : came;
}

/** The newer state of a run; an equal spec stays the same object. */
function newerOf(state: State, answer: Run, sentAt: number): Run {
  const known = state.runs.get(answer.id);
  const late = sentAt < Math.max(state.lastEvent.get(answer.id) ?? 0, state.lastReset);
  if (!late) return { ...answer, spec: newest(known?.spec, answer.spec) };
  if (!known) return { ...answer, ...state.eventsWithoutSpec.get(answer.id), spec: answer.spec };
  // Events carry no rates: those of a late answer are the newest.
  const { evaluations_per_second, eta_seconds } = answer;
  return { ...known, evaluations_per_second, eta_seconds };
}

/** Apply the answer to a change, after which lists may have other members. */
export function applyChange(state: State, answer: Run, sentAt: number): State {
  const next = countEvent(applyResponses(state, [answer], sentAt), answer.id);
  return { ...next, listVersion: state.listVersion + 1 };
}

/** Apply an edit before the server has confirmed it. */
export function applyEdit(state: State, id: string, change: RunChange): State {
  const run = state.runs.get(id);
  if (!run) return state;
  return { ...countEvent(state, id), runs: new Map(state.runs).set(id, { ...run, ...change }) };
}
