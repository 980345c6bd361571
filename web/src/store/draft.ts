/** The draft of a spec, kept until the tab is closed, and its source in the address. */

import type { Spec } from "../api/types";
import { keep, readKept } from "./kept";

export interface Base {
  kind: "preset" | "run" | "creature" | "pasted";
  /** `experiment/name` of a preset, id of a run, hash of a creature, or name of a file. */
  name: string;
  spec: Spec;
  /** True for a document; the server may not know its name. */
  fromDocument?: boolean;
  /** The initial creatures, in place of random ones. */
  fork?: ForkSource;
}

export interface ForkSource {
  /** The run of the creatures; null if unknown. */
  run: string | null;
  /** Creatures by name; null for elites of the run. */
  named: string[] | null;
  /** The cells of the elites; null for all cells. */
  cells: number[] | null;
  /** The generation of the elites; null for the newest. */
  at: number | null;
  creatures: number;
}

/** The parameters of an address that name the source of a draft. */
export type Address = (readonly [parameter: string, value: string])[];

export interface Draft {
  base: Base;
  spec: Spec;
}

const KEY = "microcosmos:draft";
const QUERIES = { preset: "preset", run: "from", creature: "creature", pasted: null };

export function addressOf({ kind, name, fromDocument, fork }: Omit<Base, "spec">): Address | null {
  if (fork) return addressOfFork(fork);
  const parameter = QUERIES[kind];
  return parameter && !fromDocument ? [[parameter, name]] : null;
}

function addressOfFork({ run, named, cells, at }: ForkSource): Address {
  if (run === null) return [["initial", named![0]!]];
  return forkAddress(run, {
    creature: named && formatCreatures(named),
    cells: cells && formatCells(cells),
    at: at === null ? null : String(at),
  });
}

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

const storage = () => sessionStorage;

export const saveDraft = (draft: Draft) => keep(KEY, draft, storage);

export function discardDraft(): void {
  sessionStorage.removeItem(KEY);
}

/** The stored draft, if its source is the requested one or none is requested. */
export function loadDraft(requested: Address | null): Draft | null {
  const draft = readKept<Draft | null>(KEY, null, storage);
  if (!draft?.base?.spec || !draft.spec) return null;
  return !requested || String(addressOf(draft.base)) === String(requested) ? draft : null;
}

export const formatCreatures = (names: readonly string[]) => names.join(",");

export const parseCreatures = (text: string) => text.split(",").filter(Boolean);

export function formatCells(cells: Iterable<number>): string {
  const ranges: [first: number, last: number][] = [];
  for (const cell of [...cells].sort((a, b) => a - b)) {
    const range = ranges.at(-1);
    if (range && cell <= range[1] + 1) range[1] = cell;
    else ranges.push([cell, cell]);
  }
  return ranges.map(([first, last]) => (first === last ? first : `${first}-${last}`)).join();
}

/** A test for the cells in a text; malformed ranges are ignored. */
export function parseCells(text: string): (cell: number) => boolean {
  const ranges = text.split(",").flatMap((range): [number, number][] => {
    const [, first, last] = /^(\d+)(?:-(\d+))?$/.exec(range) ?? [];
    return first === undefined ? [] : [[Number(first), Number(last ?? first)]];
  });
  return (cell) => ranges.some(([first, last]) => first <= cell && cell <= last);
}
