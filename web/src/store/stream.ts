/** The stream of events that updates the store while the tab is visible; visible tabs share one. */

import { EVENTS_URL } from "../api/client";
import { loadPrincipal } from "./principal";
import * as changes from "./state";
import { update } from "./store";

const RECONNECT_MS = 2000;
const CONNECT_TIMEOUT_MS = 500;
const CLOSE_HIDDEN_MS = 10_000;
/** Time in which the tab that has the stream answers, unless it is suspended. */
const ANSWER_MS = 3000;
const SHARED = "microcosmos:events";

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

/** What the tab that has the stream tells the others, and `hello`, by which they ask. */
type Message =
  | { kind: "event"; type: string; data: string }
  | { kind: "connection"; state: Connection; isNew: boolean }
  | { kind: "hello" };

/** `ended`: the server closed the stream for good, as it does when a token is revoked. */
type Connection = "connecting" | "live" | "lost" | "ended";

type Timer = ReturnType<typeof setTimeout>;

let source: EventSource | null = null;
let connection: Connection = "connecting";
let answering: Timer | undefined;
let reconnecting: Timer | undefined;
let hiding: Timer | undefined;
let channel: BroadcastChannel | null = null;
/** Gives the stream up, or the place in the line of tabs that wait for it. */
let leave: (() => void) | null = null;
/** Whether everything was fetched since this tab listens. */
let isFresh = false;
let settled = () => {};

/** Follow the stream; resolve when it is open, has failed or takes long, because opening it fetches all data again. */
export function connect(): Promise<unknown> {
  document.addEventListener("visibilitychange", followVisibility);
  followVisibility();
  return new Promise<void>((resolve) => {
    settled = resolve;
    if (document.visibilityState === "hidden") resolve();
    setTimeout(resolve, CONNECT_TIMEOUT_MS);
  });
}

function followVisibility(): void {
  clearTimeout(hiding);
  if (document.visibilityState !== "hidden") join();
  else if (leave) hiding = setTimeout(part, CLOSE_HIDDEN_MS);
}

/**
 * Wait for the stream, and listen to the tab that has it.
 *
 * A browser has six connections to a host for all tabs, and streams would occupy them all. Locks need a
 * secure context, and channels storage; without them each tab has a stream.
 */
function join(): void {
  if (leave) return;
  isFresh = false;
  const ended = new AbortController();
  leave = () => ended.abort();
  const alone = () => {
    if (!source && !ended.signal.aborted) open();
  };
  try {
    channel = new BroadcastChannel(SHARED);
    channel.onmessage = ({ data }: MessageEvent<Message>) => receive(data);
    const hold = () =>
      new Promise<void>((release) => {
        ended.signal.addEventListener("abort", () => release());
        alone();
      });
    navigator.locks.request(SHARED, { signal: ended.signal }, hold).catch(alone);
    answering = setTimeout(alone, ANSWER_MS);
    channel.postMessage({ kind: "hello" } satisfies Message);
  } catch {
    channel = null;
    alone();
  }
}

function part(): void {
  clearTimeout(reconnecting);
  clearTimeout(answering);
  source?.close();
  source = null;
  connection = "connecting";
  channel?.close();
  channel = null;
  leave?.();
  leave = null;
  update((state) => ({ ...state, connection: "connecting" }));
}

/** An EventSource reconnects without losing events; after a new one, everything is fetched again. */
function open(): void {
  const opened = new EventSource(EVENTS_URL);
  source = opened;
  let isNew = true;
  opened.onopen = () => {
    tell({ kind: "connection", state: "live", isNew });
    isNew = false;
  };
  opened.onerror = () => {
    const isOver = opened.readyState === EventSource.CLOSED;
    tell({ kind: "connection", state: isOver ? "ended" : "lost", isNew: false });
    if (isOver) reconnecting = setTimeout(open, RECONNECT_MS);
  };
  for (const type of Object.keys(CHANGES)) {
    opened.addEventListener(type, ({ data }: MessageEvent<string>) => tell({ kind: "event", type, data }));
  }
}

function tell(message: Message): void {
  channel?.postMessage(message);
  receive(message);
}

function receive(message: Message): void {
  if (message.kind === "event") {
    update((state) => CHANGES[message.type]!(state, JSON.parse(message.data) as never));
  } else if (message.kind === "connection") {
    clearTimeout(answering);
    connection = message.state;
    const shown = connection === "ended" ? "lost" : connection;
    update((state) => ({ ...state, connection: shown }));
    if (connection === "ended") void loadPrincipal(); // The stream does not say that a token was revoked.
    if (message.state === "live" && (message.isNew || !isFresh)) {
      isFresh = true;
      update(changes.reset);
    }
    settled();
  } else if (source) {
    channel?.postMessage({ kind: "connection", state: connection, isNew: false } satisfies Message);
  }
}
