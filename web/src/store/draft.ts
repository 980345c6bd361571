/** The spec that is being written, kept while the tab lives. */

import type { Spec } from "../api/types";
import { formatCells } from "./cellRanges";

/** What a spec was begun from. */
export interface Base {
  kind: "preset" | "run" | "creature" | "pasted";
  /** Of a preset `experiment/name`; a run's id, a creature's hash, a file's name. */
  name: string;
  spec: Spec;
  /** Whether it came as a file, so that this server need not know the name. */
  foreign?: boolean;
  /** Which creatures the run begins from, in place of random ones. */
  fork?: ForkSource;
}

export interface ForkSource {
  /** Whose creatures they are; null where no run is known. */
  run: string | null;
  /** The only one; null for elites of the run. */
  creature: string | null;
  /** Whose elites they are; null for those of all. */
  cells: number[] | null;
  /** The generation after which they lived there; null: as they are. */
  at: number | null;
  creatures: number;
}

/** What the address says of it: a word with a name, and of a fork which creatures. */
export type Address = (readonly [word: string, value: string])[];

export interface Draft {
  base: Base;
  spec: Spec;
}

const KEY = "microcosmos:draft";
const QUERIES = { preset: "preset", run: "from", creature: "creature", pasted: null };

/** How the address names what a spec was begun from; null where it cannot. */
export function addressOf({ kind, name, foreign, fork }: Omit<Base, "spec">): Address | null {
  if (fork) return addressOfFork(fork);
  const word = QUERIES[kind];
  return word && !foreign ? [[word, name]] : null;
}

function addressOfFork({ run, creature, cells, at }: ForkSource): Address {
  if (run === null) return [["begin", creature!]];
  return forkAddress(run, {
    creature,
    cells: cells && formatCells(cells),
    at: at === null ? null : String(at),
  });
}

/** The address of a fork: which of a run's creatures it begins from. */
export function forkAddress(
  run: string,
  which: { [name in (typeof FORK_PARAMETERS)[number]]?: string | null },
): Address {
  return [
    ["fork", run],
    ...FORK_PARAMETERS.flatMap((name) => (which[name] ? [[name, which[name]] as const] : [])),
  ];
}

export const FORK_PARAMETERS = ["creature", "cells", "at"] as const;

export function saveDraft(draft: Draft): void {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(draft));
  } catch {
    // Full, or forbidden: the draft then lives as long as the page.
  }
}

export function discardDraft(): void {
  sessionStorage.removeItem(KEY);
}

/** The draft, where it was begun from what the address names, or the address names nothing. */
export function loadDraft(wanted: Address | null): Draft | null {
  const draft = storedDraft();
  if (!draft || !wanted) return draft;
  return String(addressOf(draft.base)) === String(wanted) ? draft : null;
}

function storedDraft(): Draft | null {
  try {
    const draft = JSON.parse(sessionStorage.getItem(KEY) ?? "null") as Draft | null;
    return draft?.base?.spec && draft.spec ? draft : null;
  } catch {
    return null;
  }
}
