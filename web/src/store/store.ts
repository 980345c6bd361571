/** The store of a tab. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Run } from "../api/types";
import { applyChange, applyResponses } from "./reconcile";
import { INITIAL_STATE, type State, withViewer } from "./state";

let state = INITIAL_STATE;
const listeners = new Set<() => void>();

export const currentState = (): State => state;

export function update(change: (state: State) => State): void {
  state = change(state);
  for (const listener of listeners) listener();
}

/** Store the answer to a read or to a change of a run. */
export async function applyResponse(type: "response" | "change", request: Promise<Run>): Promise<Run> {
  const sentAt = state.eventCount;
  const run = await request;
  update((now) => (type === "change" ? applyChange(now, run, sentAt) : applyResponses(now, [run], sentAt)));
  return run;
}

/** A part of the store; the component is redrawn when that part changes. */
export function useStore<T>(select: (state: State) => T): T {
  const [, redraw] = useState(0);
  const selected = select(state);
  useEffect(() => {
    let last = selected;
    const listener = () => {
      const next = select(state);
      if (Object.is(next, last)) return;
      last = next;
      redraw((count) => count + 1);
    };
    listeners.add(listener);
    listener(); // The store may have changed since the component was drawn.
    return () => void listeners.delete(listener);
  });
  return selected;
}

/** A part of the store for each id; the component is redrawn when one of them changes. */
export function useEach<T>(ids: readonly string[], select: (state: State, id: string) => T): readonly T[] {
  const last = useRef<readonly T[]>([]);
  return useStore((state) => {
    const next = ids.map((id) => select(state, id));
    const same = next.length === last.current.length && next.every((value, i) => value === last.current[i]);
    if (!same) last.current = next;
    return last.current;
  });
}

export const useRuns = (ids: readonly string[]) => useEach(ids, ({ runs }, id) => runs.get(id));

/** Runs without a viewer stay in the store for this long. */
export const RETAIN_MS = 60_000;

/** Keep the details of runs until the returned function is called, and a little longer. */
export function retain(runs: readonly string[]): () => void {
  const change = (more: 1 | -1) =>
    update((state) => runs.reduce((now, run) => withViewer(now, run, more), state));
  change(1);
  return () => void setTimeout(change, RETAIN_MS, -1);
}
