/** Editing the name, tags and note of a run. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Run, RunChange } from "../api/types";
import { applyResponse, currentState, dispatch } from "./store";
import { dismissToast, showToast } from "./toasts";
import { text } from "./text";

/** Apply a change at once; revert it if the server refuses. */
export async function editRun(id: string, change: RunChange): Promise<void> {
  const before = currentState().runs.get(id);
  dispatch({ type: "edit", run: id, change });
  try {
    await applyResponse("change", api.changeRun(id, change));
  } catch (error) {
    if (before) {
      const { name, tags, note } = before;
      dispatch({ type: "edit", run: id, change: { name, tags, note } });
    }
    showToast({ kind: "wrong", text: messageOf(error) });
  }
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

function offerUndo(note: string, back: () => void): void {
  const undo = () => {
    dismissToast(toast);
    back();
  };
  const toast = showToast({ kind: "note", text: note, action: { label: text.undo, run: undo } });
}
