/** Motions of the visible creatures of a gallery, requested a few at a time. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { type Motion, decodeMotion } from "../decode/replay";
import { setNewest } from "./cache";
import { poll } from "./polling";

/** The renderer works in order, so a hovered cell waits for at most this number of requests. */
const MAX_REQUESTS = 8;
/** A gallery requests nothing while it is scrolled. */
const DEBOUNCE_MS = 150;
/** Motions that stay when the gallery closes. */
const MAX_HIDDEN = 100;

const cache = new Map<string, Motion>();
/** Functions that stop the requests of creatures. */
const requests = new Map<string, () => void>();
let pending: string[] = [];
const listeners = new Set<() => void>();

/** The loaded motions; missing ones of these creatures are requested in order. */
export function useMotions(shas: readonly string[]): ReadonlyMap<string, Motion> {
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
    const timer = setTimeout(() => request(shas), DEBOUNCE_MS);
    return () => clearTimeout(timer);
  }, [shas.join()]);
  return cache;
}

function request(shas: readonly string[]): void {
  for (const sha of shas) {
    const motion = cache.get(sha);
    if (motion) {
      cache.delete(sha);
      cache.set(sha, motion); // Now the newest.
    }
  }
  pending = shas.filter((sha) => !cache.has(sha) && !requests.has(sha));
  startRequests();
}

function startRequests(): void {
  while (requests.size < MAX_REQUESTS && pending.length > 0) startRequest(pending.shift()!);
}

function startRequest(sha: string): void {
  const done = () => {
    requests.delete(sha);
    startRequests();
  };
  const end = poll(async () => decoded(await api.readMotion(sha)), {
    value: (motion) => {
      setNewest(cache, sha, motion);
      done();
      for (const listener of listeners) listener();
    },
    note: () => {},
    error: done, // The tile stays still; the page of the creature shows the error.
  });
  requests.set(sha, end);
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodeMotion(bytes);

function stop(): void {
  pending = [];
  for (const end of requests.values()) end();
  requests.clear();
  for (const sha of [...cache.keys()].slice(0, -MAX_HIDDEN)) cache.delete(sha);
}
