/** Sweeps: reading them when they change, and commands for all of their runs. */

import * as api from "../api/client";
import type { Sweep, SweepChanged, SweepCurves, SweepPage, SweepSummary } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./polling";
import { orShowError, showToast, offerUndo } from "./toasts";
import { text } from "./text";

/** Points per curve, as many as a screen resolves. */
const POINTS = 300;

export function useSweeps(limit: number, enabled: boolean): Loaded<SweepPage | null> {
  const version = useStore((state) => (enabled ? `${state.epoch} ${totalOf(state.sweepVersions)}` : ""));
  const throttled = useThrottled(version);
  return useFetched(async () => (enabled ? await readSweepsUpTo(limit) : null), [throttled, limit, enabled]);
}

/** The newest sweeps; a page with long specs has fewer than were asked for. */
export async function readSweepsUpTo(limit: number): Promise<SweepPage> {
  let { items, next } = await api.readSweeps(limit);
  while (next !== null && items.length < limit) {
    const more = await api.readSweeps(limit - items.length, next);
    items = [...items, ...more.items];
    next = more.next;
  }
  return { items, next };
}

const totalOf = (counts: ReadonlyMap<string, number>) =>
  [...counts.values()].reduce((sum, count) => sum + count, 0);

export interface SweepDetail {
  sweep: Sweep;
  summary: SweepSummary;
  curves: SweepCurves | null;
}

export function useSweep(id: string, withRuns: boolean): Loaded<SweepDetail> {
  const throttled = useThrottled(useStore((state) => `${state.epoch} ${state.sweepVersions.get(id) ?? 0}`));
  return useFetched(async () => {
    const [sweep, summary, curves] = await Promise.all([
      api.readSweep(id),
      api.readSweepSummary(id, POINTS),
      withRuns ? api.readSweepCurves(id, POINTS) : null,
    ]);
    return { sweep, summary, curves };
  }, [id, throttled, withRuns]);
}

const outcome = ({ changed, skipped }: SweepChanged, done: string) =>
  text.outcome(text.runs(changed.length), done, skipped.length > 0 ? text.runs(skipped.length) : null);

export async function sendSweepCommand(id: string, verb: "pause" | "resume"): Promise<void> {
  const answer = await orShowError(api.commandSweep(id, verb));
  if (answer) showToast({ kind: "note", text: outcome(answer, text.outcomes[verb]) });
}

export const renameSweep = (id: string, name: string | null) => orShowError(api.renameSweep(id, name));

export const restoreSweep = (id: string) => orShowError(api.restoreSweep(id));

/** Move all runs to the bin. */
export async function removeSweep(id: string): Promise<void> {
  const answer = await orShowError(api.deleteSweep(id));
  if (answer) offerUndo(outcome(answer, text.deleted), () => void restoreSweep(id));
}

export async function cancelSweepWithUndo(id: string): Promise<void> {
  const answer = await orShowError(api.commandSweep(id, "cancel"));
  if (!answer) return;
  const takeBack = () => void orShowError(api.uncancelSweep(id, answer.changed));
  offerUndo(outcome(answer, text.outcomes.cancel), takeBack);
}
