/** A run, its snapshot and its events, for tests of the store. */

import type { Archive, GenerationEvent, Generations, Run, RunEvent } from "../api/types";
import * as changes from "./state";

type Change = (state: changes.State) => changes.State;

export const RUN = {
  id: "a",
  created_at: "2026-01-02T00:00:00Z",
  generation: 2,
  generations: 10,
  evaluations: 32,
  sparkline: [1, 2],
  spec: { archive: {} },
} as unknown as Run;

const ARCHIVE: Archive = {
  generation: 2,
  kind: "grid",
  cells: 16,
  coverage: 2 / 16,
  axes: [],
  recorded: [],
  measures: {},
  cell: [0, 5],
  fitness: [1, 2],
  descriptors: [
    [0, 0],
    [1, 1],
  ],
  elite_generation: [1, 2],
  creature: ["aa", "bb"],
  trusted: [false, true],
  emptied: [],
  emptied_generation: [],
};

const column = [1, 2];

const GENERATIONS: Generations = {
  generation: column,
  qd_score: column,
  coverage: column,
  best: column,
  mean: column,
  evaluations: [16, 32],
  infeasible: [0, 0],
  seconds: [1, 2],
  summary: { inserted: [5, 6], corrected: [null, 0.5] },
};

export function generationEvent(number: number): GenerationEvent {
  const [evaluations, seconds] = [16 * number, 2 * number];
  const values = { qd_score: number, coverage: number, best: number, mean: number, infeasible: 0 };
  const summary = { inserted: number, "ended.fitness": 1, ...(number % 2 === 1 && { late: number }) };
  return { run: "a", generation: number, evaluations, seconds, ...values, summary };
}

export const after = (state: changes.State, ...then: Change[]): changes.State =>
  then.reduce((now, change) => change(now), state);

export const generation =
  (number: number): Change =>
  (state) =>
    changes.withGenerationEvent(state, generationEvent(number));

export function elites(number: number, cell: number, creature: string): Change {
  const columns = { cell: [cell], fitness: [9], descriptors: [[0, 0]], creature: [creature] };
  const event = { run: "a", generation: number, elite_generation: [number], emptied: [], ...columns };
  return (state) => changes.withElitesEvent(state, event);
}

export function emptied(number: number, ...cells: number[]): Change {
  const columns = { cell: [], fitness: [], descriptors: [], creature: [], elite_generation: [] };
  const event = { run: "a", generation: number, emptied: cells, ...columns };
  return (state) => changes.withElitesEvent(state, event);
}

export const run =
  (event: RunEvent): Change =>
  (state) =>
    changes.withRunEvent(state, event);

export const rewind =
  (generation: number): Change =>
  (state) =>
    changes.withRewind(state, { run: "a", generation });

/** A snapshot that was requested in an earlier state. */
export const snapshotSince =
  (before: changes.State, archive: Archive | null = ARCHIVE): Change =>
  (state) =>
    changes.withSnapshot(state, "a", changes.epochOf(before, "a"), archive, GENERATIONS);

export const snapshot: Change = (state) => snapshotSince(state)(state);

export const open: Change = (state) => changes.withViewer(state, "a", 1);

export const close: Change = (state) => changes.withViewer(state, "a", -1);

export const opened = after(changes.INITIAL_STATE, run(RUN), open, snapshot);

export const creatures = (state: changes.State) =>
  Object.fromEntries([...state.details.get("a")!.elites].map(([cell, { creature }]) => [cell, creature]));
