/** The one store of a tab. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Run } from "../api/types";
import { type Action, INITIAL_STATE, type State, reduce } from "./reducer";

let state = INITIAL_STATE;
const listeners = new Set<() => void>();

export function currentState(): State {
  return state;
}

export function dispatch(action: Action): void {
  state = reduce(state, action);
  for (const listener of listeners) listener();
}

/** Puts in the run that was asked for, or what came of a change to it. */
export async function applyResponse(type: "response" | "change", asked: Promise<Run>): Promise<Run> {
  const sent = state.eventCount;
  const run = await asked;
  dispatch({ type, run, sent });
  return run;
}

/** A part of the store; the component is drawn again when that part changes. */
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
    listener(); // What changed between drawing and listening.
    return () => void listeners.delete(listener);
  });
  return selected;
}

/** Some runs, as far as they are known; the component is drawn again when one of them changes. */
export function useRuns(ids: readonly string[]): readonly (Run | undefined)[] {
  const last = useRef<readonly (Run | undefined)[]>([]);
  return useStore(({ runs }) => {
    const next = ids.map((id) => runs.get(id));
    const same = next.length === last.current.length && next.every((run, i) => run === last.current[i]);
    if (!same) last.current = next;
    return last.current;
  });
}
