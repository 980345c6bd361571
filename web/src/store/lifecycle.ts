/** Extending, deleting and restoring a run. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Run } from "../api/types";
import { applyResponse } from "./store";
import { dismissToast, showToast } from "./toasts";
import { text } from "./text";

/** Apply the answer of the server, or show its error. */
async function attempt(answered: Promise<Run>): Promise<boolean> {
  try {
    await applyResponse("change", answered);
    return true;
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
    return false;
  }
}

export const extend = (id: string, generations: number) => attempt(api.extendRun(id, generations));

export const restore = (id: string) => attempt(api.restoreRun(id));

/** Move a run to the bin; the note and the bin can undo it. */
export async function remove(id: string, title: string): Promise<boolean> {
  if (!(await attempt(api.deleteRun(id)))) return false;
  const back = () => {
    dismissToast(toast);
    void restore(id);
  };
  const action = { label: text.undo, run: back };
  const toast = showToast({ kind: "note", text: text.inBin(title), action });
  return true;
}
