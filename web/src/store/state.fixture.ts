/** A run, its snapshot and its events, for tests of the store. */

import type { Archive, GenerationEvent, Generations, Run } from "../api/types";
import { type Action, INITIAL_STATE, type State, epochOf, reduce } from "./reducer";

export const RUN = {
  id: "a",
  created_at: "2026-01-02T00:00:00Z",
  generation: 2,
  generations: 10,
  evaluations: 32,
  sparkline: [1, 2],
  spec: { archive: {} },
} as unknown as Run;

export const ARCHIVE: Archive = {
  generation: 2,
  kind: "grid",
  cells: 16,
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
};

export const column = [1, 2];

export const GENERATIONS: Generations = {
  generation: column,
  qd_score: column,
  coverage: column,
  best: column,
  mean: column,
  evaluations: [16, 32],
  diverged: [0, 0],
  seconds: [1, 2],
  summary: { inserted: [5, 6], corrected: [null, 0.5] },
};

export function generation(number: number): GenerationEvent {
  const [evaluations, seconds] = [16 * number, 2 * number];
  const values = { qd_score: number, coverage: number, best: number, mean: number, diverged: 0 };
  const summary = { inserted: number, ended: "words", ...(number % 2 === 1 && { late: number }) };
  return { run: "a", generation: number, evaluations, seconds, ...values, summary };
}

export function elites(number: number, cell: number, creature: string): Action {
  const columns = { cell: [cell], fitness: [9], descriptors: [[0, 0]], creature: [creature] };
  const event = { run: "a", generation: number, elite_generation: [number], ...columns };
  return { type: "elites", event };
}

export const snapshot = (state: State): Action => ({
  type: "snapshot",
  run: "a",
  epoch: epochOf(state, "a"),
  archive: ARCHIVE,
  generations: GENERATIONS,
});

export function after(...actions: (Action | ((state: State) => Action))[]): State {
  return actions.reduce<State>((state, action) => {
    return reduce(state, typeof action === "function" ? action(state) : action);
  }, INITIAL_STATE);
}

export const open: Action & { type: "open" } = { type: "open", run: "a", more: 1 };

export const opened = after({ type: "run", run: RUN }, open, snapshot);

export const creatures = (state: State) =>
  Object.fromEntries([...state.details.get("a")!.elites].map(([cell, { creature }]) => [cell, creature]));
