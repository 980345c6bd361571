/** Commands for a run: steer, extend, edit, delete and restore it. */

import * as api from "../api/client";
import type { Run, RunChange } from "../api/types";
import { applyEdit } from "./reconcile";
import { applyResponse, currentState, update } from "./store";
import { orShowError, offerUndo } from "./toasts";
import { text } from "./text";

/** Apply the answer of the server, or show its error; return true on success. */
const apply = async (request: Promise<Run>) => (await orShowError(applyResponse("change", request))) !== null;

export const sendCommand = (id: string, verb: api.RunCommand) => apply(api.commandRun(id, verb));

/** Cancel at once: a page that is closed right after must not leave the run going. */
export async function cancelWithUndo(id: string, title: string): Promise<void> {
  const done = await sendCommand(id, "cancel");
  if (done) offerUndo(text.cancelled(title), () => void sendCommand(id, "uncancel"));
}

export const extend = (id: string, generations: number) => apply(api.extendRun(id, generations));

export const restore = (id: string) => apply(api.restoreRun(id));

/** Move a run to the bin. */
export async function remove(id: string, title: string): Promise<boolean> {
  const removed = await apply(api.deleteRun(id));
  if (removed) offerUndo(text.inBin(title), () => void restore(id));
  return removed;
}

/** Change name, tags, note or scheduling at once; return true if the server accepts it. */
export async function editRun(id: string, change: RunChange): Promise<boolean> {
  update((state) => applyEdit(state, id, change));
  const accepted = await apply(api.changeRun(id, change));
  // The server alone knows what the run is now: others, or another edit, may have changed it meanwhile.
  if (!accepted) await applyResponse("response", api.readRun(id)).catch(() => {}); // A reset reads it later.
  return accepted;
}

export function addTag({ id, tags }: Run, tag: string): void {
  if (!tags.includes(tag)) void editRun(id, { tags: [...tags, tag] });
}

export async function removeTag({ id, tags }: Run, tag: string): Promise<void> {
  if (!(await editRun(id, { tags: tags.filter((each) => each !== tag) }))) return;
  offerUndo(text.tagRemoved(tag), () => {
    const run = currentState().runs.get(id);
    if (run) addTag(run, tag);
  });
}

export async function removeNote({ id, note }: Run): Promise<void> {
  if (!(await editRun(id, { note: null }))) return;
  offerUndo(text.noteRemoved, () => {
    if (!currentState().runs.get(id)?.note) void editRun(id, { note }); // A newer note stays.
  });
}
