/** The one stream of events that feeds a tab's store, while somebody looks at the tab. */

import { EVENTS_URL } from "../api/client";
import { loadPrincipal } from "./principal";
import { dispatch } from "./store";
import type { Action } from "./reducer";

const RECONNECT_MS = 2000;
const CONNECT_TIMEOUT_MS = 500;
/** A browser has six connections to a host for all its tabs: hidden ones give theirs back. */
const CLOSE_HIDDEN_MS = 10_000;

type Timer = ReturnType<typeof setTimeout>;

let source: EventSource | null = null;
let reconnecting: Timer | undefined;
let closing: Timer | undefined;

/**
 * Settled when the stream is open, has failed or takes long: what is fetched before it is open
 * has to be fetched again, so that the page had better wait.
 */
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

/**
 * EventSource reconnects by itself with Last-Event-ID; where it gave up, was closed, or is
 * the first, nobody knows what was missed, and everything is fetched again.
 */
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
    void loadPrincipal(); // A stream does not tell that a token was revoked.
  };
  listen(opened, "run", (run) => ({ type: "run", run }) as Action);
  listen(opened, "generation", (event) => ({ type: "generation", event }) as Action);
  listen(opened, "elites", (event) => ({ type: "elites", event }) as Action);
  listen(opened, "results", (event) => ({ type: "results", event }) as Action);
  listen(opened, "rewind", (event) => ({ type: "rewind", event }) as Action);
  listen(opened, "sweep", (data) => ({ type: "sweep", ...(data as object) }) as Action);
  listen(opened, "purge", (data) => ({ type: "purge", ...(data as object) }) as Action);
  listen(opened, "reset", () => ({ type: "reset" }));
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
