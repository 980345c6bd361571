/** The spec at hand, what it was begun from, and that neither is lost. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Experiment, Spec } from "../api/types";
import {
  type Base,
  type Draft,
  FORK_PARAMETERS,
  addressOf,
  discardDraft,
  loadDraft,
  saveDraft,
} from "../store/draft";
import { dismissToast, showToast } from "../store/toasts";
import { setQuery } from "../store/router";
import { changedPaths } from "./form/changes";
import { withInitial } from "./initialCreatures";
import { addressed, load, ofPreset } from "./sources";

export interface DraftState {
  work: Draft | null;
  /** Where the spec differs from what it was begun from. */
  changed: ReadonlySet<string>;
  /** Counts how often the whole spec was replaced. */
  revision: number;
  /** Whether a draft of before is shown. */
  restored: boolean;
  problem: string | null;
  change: (next: (spec: Spec) => Spec) => void;
  startFrom: (base: Base) => void;
  reset: () => void;
  /** Begins from random creatures after all; what was changed stays. */
  dropFork: () => void;
}

const WORDS = ["preset", "from", "fork", "begin", ...FORK_PARAMETERS];
const UNNAMED = Object.fromEntries(WORDS.map((word) => [word, null]));

const NONE: ReadonlySet<string> = new Set();

export function useDraft(query: URLSearchParams, experiments: Experiment[]): DraftState {
  const wanted = addressed(query);
  const [work, setWork] = useState(() => loadDraft(wanted));
  const [restored, setRestored] = useState(work !== null);
  const [revision, setRevision] = useState(0);
  const [problem, setProblem] = useState<string | null>(null);
  const shown = useRef(work ? String(wanted) : null);
  const changed = useMemo(() => (work ? new Set(changedPaths(work.spec, work.base.spec)) : NONE), [work]);
  const put = (next: Draft) => {
    const address = addressOf(next.base);
    shown.current = String(address);
    setQuery({ ...UNNAMED, ...(address && Object.fromEntries(address)) });
    setWork(next);
    setRestored(false);
    setRevision((count) => count + 1);
    setProblem(null);
  };
  const replace = (next: Draft, text: string) => {
    if (work && (changed.size > 0 || work.base.fork)) offerUndo(text, () => put(work));
    put(next);
  };
  const release = () => {
    if (!work?.base.fork) return;
    const { fork: _, ...base } = { ...work.base, spec: withInitial(work.base.spec, []) };
    replace({ base, spec: withInitial(work.spec, []) }, "It begins from random creatures.");
  };
  // A way back from here leads nowhere from another page.
  useEffect(() => () => dismissToast(undoToast), []);
  const begin = (base: Base) => replace({ base, spec: base.spec }, "Begun anew without your changes.");
  useEffect(() => {
    // Without a name in it the address means whatever is at hand.
    if (shown.current === String(wanted) || (work && !wanted)) return;
    let current = true;
    const usual = ofPreset(experiments[0]!.presets[0]!, experiments[0]!);
    const asked = wanted ? load(wanted, experiments) : Promise.resolve(usual);
    const fail = (error: unknown) => {
      if (!work) begin(usual);
      setProblem(messageOf(error));
    };
    asked.then(
      (base) => current && begin(base),
      (error) => current && fail(error),
    );
    return () => {
      current = false;
    };
  }, [String(wanted)]);
  useEffect(() => {
    if (!work) return;
    if (changed.size > 0 || work.base.foreign) saveDraft(work);
    else discardDraft();
  }, [work, changed]);
  return {
    work,
    changed,
    revision,
    restored: restored && changed.size > 0,
    problem,
    change: (next) => setWork((now) => now && { ...now, spec: next(now.spec) }),
    startFrom: begin,
    reset: () => work && replace({ ...work, spec: work.base.spec }, "Changes taken back."),
    dropFork: release,
  };
}

let undoToast = 0;

function offerUndo(text: string, undo: () => void): void {
  const run = () => {
    dismissToast(undoToast);
    undo();
  };
  dismissToast(undoToast);
  undoToast = showToast({ kind: "note", text, action: { label: "Undo", run } });
}
