/** The stream of events that updates the store while the tab is visible. */

import { EVENTS_URL } from "../api/client";
import { loadPrincipal } from "./principal";
import * as changes from "./state";
import { update } from "./store";

const RECONNECT_MS = 2000;
const CONNECT_TIMEOUT_MS = 500;
/** A browser has six connections to a host for all tabs; hidden tabs close theirs. */
const CLOSE_HIDDEN_MS = 10_000;

const CHANGES: Record<string, (state: changes.State, event: never) => changes.State> = {
  run: changes.withRunEvent,
  generation: changes.withGenerationEvent,
  elites: changes.withElitesEvent,
  results: changes.withResultsEvent,
  rewind: changes.withRewind,
  sweep: changes.withSweepEvent,
  purge: changes.withoutRun,
  reset: changes.reset,
};

type Timer = ReturnType<typeof setTimeout>;

let source: EventSource | null = null;
let reconnecting: Timer | undefined;
let closing: Timer | undefined;

/** Open the stream; resolve when it is open, has failed or takes long, because opening it fetches all data again. */
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
  let isFirst = true;
  opened.onopen = () => {
    setConnection("live");
    if (isFirst) update(changes.reset);
    isFirst = false;
  };
  opened.onerror = () => {
    setConnection("lost");
    if (opened.readyState !== EventSource.CLOSED) return;
    reconnecting = setTimeout(open, RECONNECT_MS);
    void loadPrincipal(); // The stream does not report that a token was revoked.
  };
  for (const [type, change] of Object.entries(CHANGES)) {
    opened.addEventListener(type, ({ data }: MessageEvent) =>
      update((state) => change(state, JSON.parse(data) as never)),
    );
  }
  return opened;
}

const setConnection = (connection: changes.Connection) => update((state) => ({ ...state, connection }));

function close(): void {
  clearTimeout(reconnecting);
  source?.close();
  source = null;
  setConnection("connecting");
}
