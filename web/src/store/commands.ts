/** Commands for a run: steer, extend, edit, delete and restore it. */

import * as api from "../api/client";
import type { Run, RunChange } from "../api/types";
import { applyEdit } from "./reconcile";
import { applyResponse, currentState, update } from "./store";
import { orShowError, delayWithUndo, offerUndo } from "./toasts";
import { text } from "./text";

/** Apply the answer of the server, or show its error; return true on success. */
const apply = async (request: Promise<Run>) => (await orShowError(applyResponse("change", request))) !== null;

export const sendCommand = (id: string, verb: api.RunCommand) => apply(api.commandRun(id, verb));

export const cancelWithUndo = (id: string, title: string) =>
  delayWithUndo(id, text.cancelling(title), () => void sendCommand(id, "cancel"));

export const extend = (id: string, generations: number) => apply(api.extendRun(id, generations));

export const restore = (id: string) => apply(api.restoreRun(id));

/** Move a run to the bin. */
export async function remove(id: string, title: string): Promise<boolean> {
  const removed = await apply(api.deleteRun(id));
  if (removed) offerUndo(text.inBin(title), () => void restore(id));
  return removed;
}

/** Change name, tags, note or scheduling at once; revert the change if the server refuses it. */
export async function editRun(id: string, change: RunChange): Promise<void> {
  const before = currentState().runs.get(id);
  update((state) => applyEdit(state, id, change));
  if ((await apply(api.changeRun(id, change))) || !before) return;
  const { name, tags, note, priority, labels, may_yield, device_patience } = before;
  const known = { name, tags, note, priority, labels, may_yield, device_patience };
  update((state) => applyEdit(state, id, known));
}

export function addTag({ id, tags }: Run, tag: string): void {
  if (!tags.includes(tag)) void editRun(id, { tags: [...tags, tag] });
}

export function removeTag({ id, tags }: Run, tag: string): void {
  void editRun(id, { tags: tags.filter((each) => each !== tag) });
  offerUndo(text.tagRemoved(tag), () => {
    const run = currentState().runs.get(id);
    if (run) addTag(run, tag);
  });
}

export function removeNote({ id, note }: Run): void {
  void editRun(id, { note: null });
  offerUndo(text.noteRemoved, () => void editRun(id, { note }));
}
