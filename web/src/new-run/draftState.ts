/** The draft of a spec: its source, its changes, and how both are kept. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Experiment, Spec } from "../api/types";
import {
  type Address,
  type Base,
  type Draft,
  FORK_PARAMETERS,
  addressOf,
  discardDraft,
  loadDraft,
  saveDraft,
} from "../store/draft";
import { dismissToast, offerUndo } from "../store/toasts";
import { setQuery } from "../store/router";
import { changedPaths } from "./form/document";
import { withInitial } from "./initialCreatures";
import { sourceAddress, load, baseOfPreset } from "./sources";
import { text } from "./text";

const SOURCE_PARAMETERS = ["preset", "from", "fork", "initial", ...FORK_PARAMETERS];
const NO_SOURCE = Object.fromEntries(SOURCE_PARAMETERS.map((name) => [name, null]));

const NONE: ReadonlySet<string> = new Set();

export function useDraft(query: URLSearchParams, experiments: Experiment[]) {
  const requested = sourceAddress(query);
  const [current, setCurrent] = useState(() => loadDraft(requested));
  const [restored, setRestored] = useState(current !== null);
  const [revision, setRevision] = useState(0);
  const [problem, setProblem] = useState<string | null>(null);
  const shownAddress = useRef(current ? String(requested) : null);
  const changed = useMemo(
    () => (current ? new Set(changedPaths(current.spec, current.base.spec)) : NONE),
    [current],
  );
  const setDraft = (next: Draft) => {
    const address = addressOf(next.base);
    shownAddress.current = String(address);
    setQuery({ ...NO_SOURCE, ...(address && Object.fromEntries(address)) });
    setCurrent(next);
    setRestored(false);
    setRevision((count) => count + 1);
    setProblem(null);
  };
  const replace = (next: Draft, note: string) => {
    if (current && (changed.size > 0 || current.base.fork)) replaceUndo(note, () => setDraft(current));
    setDraft(next);
  };
  const startFrom = (base: Base) => replace({ base, spec: base.spec }, text.replaced);
  useBase(requested, shownAddress, current !== null, experiments, startFrom, setProblem);
  useStoredDraft(current, changed);
  return {
    current,
    changed,
    revision,
    restored: restored && changed.size > 0,
    problem,
    change: (next: (spec: Spec) => Spec) => setCurrent((now) => now && { ...now, spec: next(now.spec) }),
    startFrom,
    reset: () => current && replace({ ...current, spec: current.base.spec }, text.undone),
    dropFork: () => {
      if (current?.base.fork) replace(withoutFork(current), text.random);
    },
  };
}

export type DraftState = ReturnType<typeof useDraft>;

function withoutFork({ base: { fork: _, ...base }, spec }: Draft): Draft {
  return { base: { ...base, spec: withInitial(base.spec, []) }, spec: withInitial(spec, []) };
}

/** Start from the source in the address, or from the first preset, unless the draft shows it already. */
function useBase(
  requested: Address | null,
  shownAddress: { current: string | null },
  hasDraft: boolean,
  experiments: Experiment[],
  startFrom: (base: Base) => void,
  onProblem: (problem: string) => void,
): void {
  useEffect(() => {
    // An address without a source keeps the current draft.
    if (shownAddress.current === String(requested) || (hasDraft && !requested)) return;
    let isCurrent = true;
    const firstPreset = baseOfPreset(experiments[0]!.presets[0]!, experiments[0]!);
    const loading = requested ? load(requested, experiments) : Promise.resolve(firstPreset);
    const fail = (error: unknown) => {
      if (!hasDraft) startFrom(firstPreset);
      onProblem(messageOf(error));
    };
    loading.then(
      (base) => isCurrent && startFrom(base),
      (error) => isCurrent && fail(error),
    );
    return () => {
      isCurrent = false;
    };
  }, [String(requested)]);
}

/** Keep changes in this tab; remove the undo note when the page is left. */
function useStoredDraft(current: Draft | null, changed: ReadonlySet<string>): void {
  useEffect(() => () => dismissToast(undoToast), []);
  useEffect(() => {
    if (!current) return;
    if (changed.size > 0 || current.base.fromDocument) saveDraft(current);
    else discardDraft();
  }, [current, changed]);
}

let undoToast = 0;

function replaceUndo(note: string, undo: () => void): void {
  dismissToast(undoToast);
  undoToast = offerUndo(note, undo);
}
