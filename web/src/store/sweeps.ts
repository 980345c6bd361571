/** Sweeps: reading them when they change, and commands for all of their runs. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Sweep, SweepChanged, SweepCurves, SweepPage, SweepSummary } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./throttle";
import { dismissToast, showToast } from "./toasts";
import { text } from "./text";

/** More points than a screen can show apart would only be slower. */
const POINTS = 300;
const UNDO_MS = 4000;

/** The newest sweeps. */
export function useSweeps(limit: number, wanted: boolean): Loaded<SweepPage | null> {
  const heard = useStore((state) => (wanted ? `${state.epoch} ${totalOf(state.sweepVersions)}` : ""));
  const news = useThrottled(heard);
  return useFetched(async () => (wanted ? await api.readSweeps(limit) : null), [news, limit, wanted]);
}

const totalOf = (counts: ReadonlyMap<string, number>) =>
  [...counts.values()].reduce((sum, count) => sum + count, 0);

export interface SweepDetail {
  sweep: Sweep;
  summary: SweepSummary;
  /** The curves of each run, if wanted. */
  curves: SweepCurves | null;
}

/** A sweep with the summary of its runs. */
export function useSweep(id: string, each: boolean): Loaded<SweepDetail> {
  const news = useThrottled(useStore((state) => `${state.epoch} ${state.sweepVersions.get(id) ?? 0}`));
  return useFetched(async () => {
    const [sweep, summary, curves] = await Promise.all([
      api.readSweep(id),
      api.readSweepSummary(id, POINTS),
      each ? api.readSweepCurves(id, POINTS) : null,
    ]);
    return { sweep, summary, curves };
  }, [id, news, each]);
}

const DONE: Record<api.RunCommand, string> = {
  pause: text.pausing,
  resume: text.queued,
  cancel: text.cancellingRuns,
};

/** Await a request; show the error if it fails. */
async function attempt<T>(answered: Promise<T>): Promise<T | null> {
  try {
    return await answered;
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
    return null;
  }
}

/** Count the runs that changed and those that did not. */
const outcome = ({ changed, skipped }: SweepChanged, done: string) =>
  text.outcome(text.runs(changed.length), done, skipped.length > 0 ? text.runs(skipped.length) : null);

/** Send a command to every run. */
export async function sendSweepCommand(id: string, verb: api.RunCommand): Promise<void> {
  const answer = await attempt(api.commandSweep(id, verb));
  if (answer) showToast({ kind: "note", text: outcome(answer, DONE[verb]) });
}

export const renameSweep = (id: string, name: string | null) => attempt(api.renameSweep(id, name));

export const restoreSweep = (id: string) => attempt(api.restoreSweep(id));

/** Move all runs to the bin; the note and the page can undo it. */
export async function removeSweep(id: string): Promise<void> {
  const answer = await attempt(api.deleteSweep(id));
  if (!answer) return;
  const back = () => {
    dismissToast(toast);
    void restoreSweep(id);
  };
  const note = outcome(answer, text.deleted);
  const toast = showToast({ kind: "note", text: note, action: { label: text.undo, run: back } });
}

/** Cancel all runs after a delay in which it can be undone. */
export function cancelSweepWithUndo(id: string, title: string): void {
  const timer = setTimeout(() => void sendSweepCommand(id, "cancel"), UNDO_MS);
  const undo = () => {
    clearTimeout(timer);
    dismissToast(toast);
  };
  const action = { label: text.undo, run: undo };
  const toast = showToast({ kind: "note", text: text.cancellingSweep(title), action });
}
