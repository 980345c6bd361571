/** Sweeps, asked for anew when there is news of them, and what is asked of their runs. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Sweep, SweepCurves, SweepPage, SweepSummary } from "../api/types";
import { type Loaded, useFetched } from "./fetching";
import { useLive } from "./live";
import { usePaced } from "./pacing";
import { dismiss, tell } from "./toasts";

/** More points than a screen can show apart would only be slower. */
const POINTS = 300;
const UNDO_MS = 4000;

/** The newest sweeps. */
export function useSweeps(limit: number, wanted: boolean): Loaded<SweepPage | null> {
  const heard = useLive((state) => (wanted ? `${state.epoch} ${totalOf(state.swept)}` : ""));
  const news = usePaced(heard);
  return useFetched(async () => (wanted ? await api.readSweeps(limit) : null), [news, limit, wanted]);
}

const totalOf = (counts: ReadonlyMap<string, number>) =>
  [...counts.values()].reduce((sum, count) => sum + count, 0);

export interface Whole {
  sweep: Sweep;
  summary: SweepSummary;
  /** Each run by itself, where that is wanted. */
  curves: SweepCurves | null;
}

/** A sweep with what its runs say together, as far as they are. */
export function useSweep(id: string, each: boolean): Loaded<Whole> {
  const news = usePaced(useLive((state) => `${state.epoch} ${state.swept.get(id) ?? 0}`));
  return useFetched(async () => {
    const [sweep, summary, curves] = await Promise.all([
      api.readSweep(id),
      api.readSweepSummary(id, POINTS),
      each ? api.readSweepCurves(id, POINTS) : null,
    ]);
    return { sweep, summary, curves };
  }, [id, news, each]);
}

const DONE: Record<api.Wish, string> = {
  pause: "asked to pause",
  resume: "queued again",
  cancel: "asked to cancel",
};

/** Asks it of every run, and says how many could not. */
export async function steer(id: string, verb: api.Wish): Promise<void> {
  try {
    const { changed, left } = await api.steerSweep(id, verb);
    const rest = left.length > 0 ? `; ${runs(left.length)} left as they were` : "";
    tell({ kind: "note", text: `${runs(changed.length)} ${DONE[verb]}${rest}.` });
  } catch (error) {
    tell({ kind: "wrong", text: messageOf(error) });
  }
}

const runs = (count: number) => `${count} ${count === 1 ? "run" : "runs"}`;

/** A cancel waits a moment, so that it can be taken back. */
export function cancelSweepSoon(id: string, title: string): void {
  const timer = setTimeout(() => void steer(id, "cancel"), UNDO_MS);
  const undo = () => {
    clearTimeout(timer);
    dismiss(toast);
  };
  const action = { label: "Undo", run: undo };
  const toast = tell({ kind: "note", text: `Cancelling all runs of ${title} …`, action });
}
