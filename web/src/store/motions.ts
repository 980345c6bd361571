/** Motions of many creatures: a few asked for at a time, those that are seen kept. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { type Motion, decodeMotion } from "../decode/motion";
import { poll } from "./polling";

/** The renderer makes one replay after another: a hovered cell waits behind these, not a wall. */
const AT_ONCE = 8;
/** So many that are not seen any more are kept: who scrolls back finds them. */
const SPARE = 100;
/** A wall that is scrolled asks for nothing until it rests. */
const REST_MS = 150;

const kept = new Map<string, Motion>();
let seen: ReadonlySet<string> = new Set();
/** What is being asked for, and how to stop asking. */
const underway = new Map<string, () => void>();
let waiting: string[] = [];
const listeners = new Set<() => void>();

/** The motions there are; of these creatures those that lack are asked for in their order. */
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
    const timer = setTimeout(() => want(shas), REST_MS);
    return () => clearTimeout(timer);
  }, [shas.join()]);
  return kept;
}

function want(shas: readonly string[]): void {
  seen = new Set(shas);
  for (const sha of shas) {
    const motion = kept.get(sha);
    if (motion) keep(sha, motion);
  }
  waiting = shas.filter((sha) => !kept.has(sha) && !underway.has(sha));
  fill();
}

function fill(): void {
  while (underway.size < AT_ONCE && waiting.length > 0) begin(waiting.shift()!);
}

function begin(sha: string): void {
  const done = () => {
    underway.delete(sha);
    fill();
  };
  const end = poll(async () => decoded(await api.readMotion(sha)), {
    value: (motion) => {
      keep(sha, motion);
      done();
      for (const listener of listeners) listener();
    },
    note: () => {},
    error: done, // It stays still; its own page says what is wrong.
  });
  underway.set(sha, end);
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodeMotion(bytes);

function stop(): void {
  waiting = [];
  for (const end of underway.values()) end();
  underway.clear();
  seen = new Set();
  trim();
}

/** As the newest. */
function keep(sha: string, motion: Motion): void {
  kept.delete(sha);
  kept.set(sha, motion);
  trim();
}

/** Of those that are not seen the oldest go where there are too many. */
function trim(): void {
  for (const oldest of kept.keys()) {
    if (kept.size <= seen.size + SPARE) break;
    if (!seen.has(oldest)) kept.delete(oldest);
  }
}
