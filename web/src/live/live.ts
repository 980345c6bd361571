/** The one store of a tab, and the one stream of events that feeds it. */

import { useEffect, useState } from "preact/hooks";
import { EVENTS_URL } from "../api/client";
import { type Action, EMPTY, type State, reduce } from "./store";

let state = EMPTY;
const listeners = new Set<() => void>();

export function current(): State {
  return state;
}

export function dispatch(action: Action): void {
  state = reduce(state, action);
  for (const listener of listeners) listener();
}

/** A part of the store; the component is drawn again when that part changes. */
export function useLive<T>(select: (state: State) => T): T {
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

const RECONNECT_MS = 2000;

/**
 * Opens the stream, for as long as the page lives.
 *
 * EventSource reconnects by itself with Last-Event-ID; where it gives up, or at the first
 * start, nobody knows what was missed, and everything is fetched again.
 */
export function connect(): void {
  const source = new EventSource(EVENTS_URL);
  let fresh = true;
  source.onopen = () => {
    dispatch({ type: "connection", connection: "live" });
    if (fresh) dispatch({ type: "reset" });
    fresh = false;
  };
  source.onerror = () => {
    dispatch({ type: "connection", connection: "lost" });
    if (source.readyState !== EventSource.CLOSED) return;
    setTimeout(connect, RECONNECT_MS);
  };
  listen(source, "run", (run) => ({ type: "run", run }) as Action);
  listen(source, "generation", (event) => ({ type: "generation", event }) as Action);
  listen(source, "elites", (event) => ({ type: "elites", event }) as Action);
  listen(source, "rewind", (event) => ({ type: "rewind", event }) as Action);
  listen(source, "reset", () => ({ type: "reset" }));
}

function listen(source: EventSource, name: string, action: (data: unknown) => Action): void {
  source.addEventListener(name, (event) => dispatch(action(JSON.parse(event.data))));
}
