/** Pose streams of visible creatures: those of an archive in batches, others one at a time. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { type PoseStream, decodePoseBatch, decodePoses } from "../decode/poses";
import { setNewest } from "./cache";
import { poll, usePolled } from "./polling";

/** Cells of a batch. */
const BATCH = 100;
/** The renderer works in order, so a hovered cell waits for at most this number of requests. */
const MAX_REQUESTS = 8;
/** A gallery requests nothing while it is scrolled. */
const DEBOUNCE_MS = 150;

/** A creature and the cell whose elite it is. */
export interface Visible {
  cell: number;
  creature: string;
}

const cache = new Map<string, PoseStream>();
/** Creatures whose batch is on its way. */
const batched = new Set<string>();
/** Creatures without a stored stream. */
const lacking = new Set<string>();
/** Functions that stop the requests of single creatures. */
const requests = new Map<string, () => void>();
let pending: string[] = [];
const listeners = new Set<() => void>();

/**
 * The loaded streams; missing ones of these elites are requested: in batches if they are the elites of
 * a run's cells. `at` is null for the newest.
 */
export function usePoses(
  run: string | null,
  at: number | null,
  visible: readonly Visible[],
): ReadonlyMap<string, PoseStream> {
  const [, redraw] = useState(0);
  useEffect(() => {
    const listener = () => redraw((count) => count + 1);
    listeners.add(listener);
    return () => {
      listeners.delete(listener);
      if (listeners.size === 0) stop();
    };
  }, []);
  useEffect(() => {
    const timer = setTimeout(() => request(run, at, visible), DEBOUNCE_MS);
    return () => clearTimeout(timer);
  }, [run, at, visible.map(({ creature }) => creature).join()]);
  return cache;
}

function request(run: string | null, at: number | null, visible: readonly Visible[]): void {
  for (const { creature } of visible) {
    const stream = cache.get(creature);
    if (!stream) continue;
    cache.delete(creature);
    cache.set(creature, stream); // Now the newest.
  }
  const missing = visible.filter(({ creature }) => !cache.has(creature));
  const alone = (sha: string) => (run === null || lacking.has(sha)) && !requests.has(sha);
  pending = missing.map(({ creature }) => creature).filter(alone);
  const unknown =
    run === null ? [] : missing.filter(({ creature }) => !lacking.has(creature) && !batched.has(creature));
  for (let first = 0; first < unknown.length; first += BATCH) {
    void requestBatch(run!, at, unknown.slice(first, first + BATCH));
  }
  startRequests();
}

async function requestBatch(run: string, at: number | null, elites: Visible[]): Promise<void> {
  for (const { creature } of elites) batched.add(creature);
  const cells = elites.map(({ cell }) => cell);
  const answer = api.readArchivePoses(run, cells, at === null ? {} : { generation: at });
  // After a failure the creatures are requested one at a time, which is repeated.
  for (const stream of await answer.then(decodePoseBatch, () => [])) add(stream);
  for (const { creature } of elites) {
    batched.delete(creature);
    if (cache.has(creature)) continue;
    lacking.add(creature);
    if (listeners.size > 0) pending.push(creature);
  }
  startRequests();
}

function add(stream: PoseStream): void {
  setNewest(cache, stream.header.creature, stream);
  for (const listener of listeners) listener();
}

function startRequests(): void {
  while (requests.size < MAX_REQUESTS && pending.length > 0) startRequest(pending.shift()!);
}

function startRequest(sha: string): void {
  const done = () => {
    requests.delete(sha);
    startRequests();
  };
  const end = poll(() => readStream(sha), {
    value: (stream) => {
      add(stream);
      done();
    },
    note: () => {},
    error: done, // The tile stays still; the page of the creature shows the error.
  });
  requests.set(sha, end);
}

/** The stream of a creature; null while its replay is rendered because none is stored. */
async function readStream(sha: string): Promise<PoseStream | null> {
  const bytes = await api.readPoses(sha);
  return bytes && decodePoses(bytes);
}

function stop(): void {
  pending = [];
  for (const end of requests.values()) end();
  requests.clear();
}

/** The stream of one creature; null while it is loaded, or made from a replay that is rendered. */
export function usePoseStream(sha: string | null) {
  const known = (sha && cache.get(sha)) || null;
  const ask = async () => {
    const stream = await readStream(sha!);
    if (stream) add(stream);
    return stream;
  };
  const { value, answered, error } = usePolled(sha && !known ? ask : null, [sha]);
  const stream = known ?? (value?.header.creature === sha ? value : null);
  return { stream, rendering: answered && !stream, error };
}
