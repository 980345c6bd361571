/** Pose streams of visible creatures: in batches where the server has them, others one at a time. */

import { useEffect, useMemo, useState } from "preact/hooks";
import * as api from "../api/client";
import { type PoseStream, decodePoseBatch, decodePoses } from "../decode/poses";
import { setNewest } from "./cache";
import { poll, usePolled } from "./polling";

/** Creatures of a batch. */
const BATCH = 100;
/** The renderer works in order, so a hovered cell waits for at most this number of requests. */
const MAX_REQUESTS = 8;
/** A gallery requests nothing while it is scrolled. */
const DEBOUNCE_MS = 150;

export interface Visible {
  creature: string;
}

/** Reads the stored pose streams of some creatures at once. */
export type ReadBatch<T extends Visible> = (some: readonly T[]) => Promise<ArrayBuffer>;

export const readTankBatch = (some: readonly Visible[]) =>
  api.readTankPoses(some.map(({ creature }) => creature));

/** Reads the pose streams of a run's cells; `at` is a generation, null for the newest. */
export function readArchiveBatch(run: string, at: number | null): ReadBatch<Visible & { cell: number }> {
  const when = at === null ? {} : { generation: at };
  return (elites) =>
    api.readArchivePoses(
      run,
      elites.map(({ cell }) => cell),
      when,
    );
}

const cache = new Map<string, PoseStream>();
/** Functions that stop the requests of batches, by creature. */
const batched = new Map<string, () => void>();
/** Creatures without a stored stream. */
const lacking = new Set<string>();
/** Functions that stop the requests of single creatures. */
const requests = new Map<string, () => void>();
/** Creatures that each list on the page wants rendered, in its order. */
const waiting = new Map<symbol, string[]>();
const listeners = new Set<() => void>();

/**
 * The loaded streams; missing ones are requested in batches. What no batch has is requested one at a
 * time, which renders it, unless `render` is false.
 */
export function usePoses<T extends Visible>(
  readBatch: ReadBatch<T> | null,
  visible: readonly T[],
  render = true,
): ReadonlyMap<string, PoseStream> {
  const [, redraw] = useState(0);
  const list = useMemo(() => Symbol(), []);
  useEffect(() => {
    const listener = () => redraw((count) => count + 1);
    listeners.add(listener);
    return () => {
      listeners.delete(listener);
      waiting.delete(list);
      if (listeners.size === 0) stop();
    };
  }, []);
  useEffect(() => {
    const timer = setTimeout(() => request(list, readBatch, visible, render), DEBOUNCE_MS);
    return () => clearTimeout(timer);
  }, [readBatch === null, visible.map(({ creature }) => creature).join()]);
  return cache;
}

/** Request what a list shows; what it showed before is requested no more. */
export function request<T extends Visible>(
  list: symbol,
  readBatch: ReadBatch<T> | null,
  visible: readonly T[],
  render: boolean,
): void {
  for (const { creature } of visible) {
    const stream = cache.get(creature);
    if (!stream) continue;
    cache.delete(creature);
    cache.set(creature, stream); // Now the newest.
  }
  const missing = visible.filter(({ creature }) => !cache.has(creature));
  waiting.set(list, render ? missing.map(({ creature }) => creature) : []);
  const unknown = missing.filter(({ creature }) => !lacking.has(creature) && !batched.has(creature));
  for (let first = 0; readBatch && first < unknown.length; first += BATCH) {
    requestBatch(readBatch, unknown.slice(first, first + BATCH));
  }
  startRequests();
}

function requestBatch<T extends Visible>(readBatch: ReadBatch<T>, elites: T[]): void {
  const done = () => {
    for (const { creature } of elites) batched.delete(creature);
    startRequests();
  };
  const end = poll(() => readBatch(elites).then(decodePoseBatch), {
    value: (streams) => {
      for (const stream of streams) add(stream);
      for (const { creature } of elites) if (!cache.has(creature)) lacking.add(creature);
      done();
    },
    note: () => {},
    error: done, // A later request asks again.
  });
  for (const { creature } of elites) batched.set(creature, end);
}

function add(stream: PoseStream): void {
  setNewest(cache, stream.header.creature, stream);
  for (const listener of listeners) listener();
}

function startRequests(): void {
  while (requests.size < MAX_REQUESTS) {
    const sha = nextWaiting();
    if (sha === null) return;
    if (!cache.has(sha) && !requests.has(sha)) startRequest(sha);
  }
}

/** The first creature that waits and is in no batch; it waits no more. */
function nextWaiting(): string | null {
  for (const creatures of waiting.values()) {
    const place = creatures.findIndex((sha) => !batched.has(sha));
    if (place >= 0) return creatures.splice(place, 1)[0]!;
  }
  return null;
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
  waiting.clear();
  for (const started of [batched, requests]) {
    for (const end of started.values()) end();
    started.clear();
  }
}

/** The stream of a creature if it is loaded, else null. */
export const loadedStream = (sha: string): PoseStream | null => cache.get(sha) ?? null;

/** The stream of one creature; null while it is loaded, or made from a replay that is rendered. */
export function usePoseStream(sha: string | null) {
  const known = sha === null ? null : loadedStream(sha);
  const ask = async () => {
    const stream = await readStream(sha!);
    if (stream) add(stream);
    return stream;
  };
  const { value, answered, error } = usePolled(sha && !known ? ask : null, [sha]);
  const stream = known ?? (value?.header.creature === sha ? value : null);
  return { stream, rendering: answered && !stream, error };
}
