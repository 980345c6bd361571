/** A run's further life: more generations, the bin and the way out of it. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Run } from "../api/types";
import { applyResponse } from "./store";
import { dismissToast, showToast } from "./toasts";

/** What the server answers is shown; where it refuses, its words are. */
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

/** Into the bin at once; the note leads back, and so does the bin. */
export async function remove(id: string, title: string): Promise<boolean> {
  if (!(await attempt(api.deleteRun(id)))) return false;
  const back = () => {
    dismissToast(toast);
    void restore(id);
  };
  const action = { label: "Undo", run: back };
  const toast = showToast({ kind: "note", text: `${title} is in the bin.`, action });
  return true;
}
