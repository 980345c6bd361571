/** What people say of a run: its name, its tags, a note. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Run, RunChange } from "../api/types";
import { answer, current, dispatch } from "./store";
import { dismiss, tell } from "./toasts";

/** Shown at once; taken back where the server refuses it. */
export async function say(id: string, change: RunChange): Promise<void> {
  const before = current().runs.get(id);
  dispatch({ type: "said", run: id, change });
  try {
    await answer("done", api.changeRun(id, change));
  } catch (error) {
    if (before) {
      const { name, tags, note } = before;
      dispatch({ type: "said", run: id, change: { name, tags, note } });
    }
    tell({ kind: "wrong", text: messageOf(error) });
  }
}

export function addTag({ id, tags }: Run, tag: string): void {
  if (!tags.includes(tag)) void say(id, { tags: [...tags, tag] });
}

export function removeTag({ id, tags }: Run, tag: string): void {
  void say(id, { tags: tags.filter((each) => each !== tag) });
  undoable(`Removed the tag ${tag}.`, () => {
    const run = current().runs.get(id);
    if (run) addTag(run, tag);
  });
}

export function removeNote({ id, note }: Run): void {
  void say(id, { note: null });
  undoable("Removed the note.", () => void say(id, { note }));
}

function undoable(text: string, back: () => void): void {
  const undo = () => {
    dismiss(toast);
    back();
  };
  const toast = tell({ kind: "note", text, action: { label: "Undo", run: undo } });
}
