/** Sweeps, asked for anew when there is news of them, and what is asked of their runs. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Sweep, SweepChanged, SweepCurves, SweepPage, SweepSummary } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./throttle";
import { dismissToast, showToast } from "./toasts";

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
  /** Each run by itself, where that is wanted. */
  curves: SweepCurves | null;
}

/** A sweep with what its runs say together, as far as they are. */
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
  pause: "asked to pause",
  resume: "queued again",
  cancel: "asked to cancel",
};

/** What was asked, once it is done; what the server says where it refuses. */
async function attempt<T>(answered: Promise<T>): Promise<T | null> {
  try {
    return await answered;
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
    return null;
  }
}

/** How many runs did it, and how many could not. */
const outcome = ({ changed, skipped }: SweepChanged, done: string) =>
  `${countRuns(changed.length)} ${done}${skipped.length > 0 ? `; ${countRuns(skipped.length)} left as they were` : ""}.`;

/** Asks it of every run. */
export async function sendSweepCommand(id: string, verb: api.RunCommand): Promise<void> {
  const answer = await attempt(api.commandSweep(id, verb));
  if (answer) showToast({ kind: "note", text: outcome(answer, DONE[verb]) });
}

export const renameSweep = (id: string, name: string | null) => attempt(api.renameSweep(id, name));

export const restoreSweep = (id: string) => attempt(api.restoreSweep(id));

/** Its runs into the bin at once; the note leads back, and so does the page. */
export async function removeSweep(id: string): Promise<void> {
  const answer = await attempt(api.deleteSweep(id));
  if (!answer) return;
  const back = () => {
    dismissToast(toast);
    void restoreSweep(id);
  };
  const text = outcome(answer, "put into the bin");
  const toast = showToast({ kind: "note", text, action: { label: "Undo", run: back } });
}

const countRuns = (count: number) => `${count} ${count === 1 ? "run" : "runs"}`;

/** A cancel waits a moment, so that it can be taken back. */
export function cancelSweepWithUndo(id: string, title: string): void {
  const timer = setTimeout(() => void sendSweepCommand(id, "cancel"), UNDO_MS);
  const undo = () => {
    clearTimeout(timer);
    dismissToast(toast);
  };
  const action = { label: "Undo", run: undo };
  const toast = showToast({ kind: "note", text: `Cancelling all runs of ${title} …`, action });
}
