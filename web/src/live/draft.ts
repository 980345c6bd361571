/** The spec that is being written, kept while the tab lives. */

import type { Spec } from "../api/types";

/** What a spec was begun from. */
export interface Base {
  kind: "preset" | "run" | "creature" | "pasted";
  /** Of a preset `experiment/name`; a run's id, a creature's hash, a file's name. */
  name: string;
  spec: Spec;
  /** Whether it came as a file, so that this server need not know the name. */
  foreign?: boolean;
  /** Which creatures the run begins from, in place of random ones. */
  fork?: Forking;
}

export interface Forking {
  /** Whose creatures they are; null where no run is known. */
  run: string | null;
  /** The only one; null for all elites of the run. */
  creature: string | null;
  creatures: number;
}

/** A word of the address with a name; of a fork also the creature, where it is one. */
export type Address = [word: string, name: string, creature?: string];

export interface Work {
  base: Base;
  spec: Spec;
}

const KEY = "microcosmos:draft";
const QUERIES = { preset: "preset", run: "from", creature: "creature", pasted: null };

/** How the address names what a spec was begun from; null where it cannot. */
export function addressOf({ kind, name, foreign, fork }: Omit<Base, "spec">): Address | null {
  if (fork) return addressOfFork(fork);
  const word = QUERIES[kind];
  return word && !foreign ? [word, name] : null;
}

function addressOfFork({ run, creature }: Forking): Address {
  if (run === null) return ["begin", creature!];
  return creature === null ? ["fork", run] : ["fork", run, creature];
}

export function keep(work: Work): void {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(work));
  } catch {
    // Full, or forbidden: the draft then lives as long as the page.
  }
}

export function discard(): void {
  sessionStorage.removeItem(KEY);
}

/** The draft, where it was begun from what the address names, or the address names nothing. */
export function draftFor(wanted: Address | null): Work | null {
  const work = kept();
  if (!work || !wanted) return work;
  return String(addressOf(work.base)) === String(wanted) ? work : null;
}

function kept(): Work | null {
  try {
    const work = JSON.parse(sessionStorage.getItem(KEY) ?? "null") as Work | null;
    return work?.base?.spec && work.spec ? work : null;
  } catch {
    return null;
  }
}
