/** The stream of events that updates the store while the tab is visible. */

import { EVENTS_URL } from "../api/client";
import { loadPrincipal } from "./principal";
import { dispatch } from "./store";
import type { Action } from "./reducer";

const RECONNECT_MS = 2000;
const CONNECT_TIMEOUT_MS = 500;
/** A browser has six connections to a host for all tabs; hidden tabs close theirs. */
const CLOSE_HIDDEN_MS = 10_000;

type Timer = ReturnType<typeof setTimeout>;

let source: EventSource | null = null;
let reconnecting: Timer | undefined;
let closing: Timer | undefined;

/** Open the stream; wait until it is open, has failed or takes long, because opening it fetches all data again. */
export function connect(): Promise<unknown> {
  document.addEventListener("visibilitychange", followVisibility);
  const opened = open();
  followVisibility();
  return new Promise((resolve) => {
    for (const event of ["open", "error"]) opened.addEventListener(event, resolve);
    setTimeout(resolve, CONNECT_TIMEOUT_MS);
  });
}

function followVisibility(): void {
  clearTimeout(closing);
  if (document.visibilityState === "hidden") closing = setTimeout(close, CLOSE_HIDDEN_MS);
  else if (!source) open();
}

/** An EventSource reconnects without losing events; after a new one, everything is fetched again. */
function open(): EventSource {
  const opened = new EventSource(EVENTS_URL);
  source = opened;
  let fresh = true;
  opened.onopen = () => {
    dispatch({ type: "connection", connection: "live" });
    if (fresh) dispatch({ type: "reset" });
    fresh = false;
  };
  opened.onerror = () => {
    dispatch({ type: "connection", connection: "lost" });
    if (opened.readyState !== EventSource.CLOSED) return;
    reconnecting = setTimeout(open, RECONNECT_MS);
    void loadPrincipal(); // The stream does not report that a token was revoked.
  };
  listen(opened, "run", (run) => ({ type: "run", run }) as Action);
  for (const type of ["generation", "elites", "results", "rewind"]) {
    listen(opened, type, (event) => ({ type, event }) as Action);
  }
  for (const type of ["sweep", "purge", "reset"]) {
    listen(opened, type, (data) => ({ type, ...(data as object) }) as Action);
  }
  return opened;
}

function close(): void {
  clearTimeout(reconnecting);
  source?.close();
  source = null;
  dispatch({ type: "connection", connection: "connecting" });
}

function listen(from: EventSource, name: string, action: (data: unknown) => Action): void {
  from.addEventListener(name, (event) => dispatch(action(JSON.parse(event.data))));
}
