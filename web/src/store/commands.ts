/** What people ask of a run. A cancel waits a moment, so that it can be taken back. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import { answer } from "./store";
import { dismiss, tell } from "./toasts";

const UNDO_MS = 4000;

export async function ask(id: string, verb: api.Wish): Promise<void> {
  try {
    await answer("done", api.wish(id, verb));
  } catch (error) {
    tell({ kind: "wrong", text: messageOf(error) });
  }
}

export function cancelSoon(id: string, title: string): void {
  const timer = setTimeout(() => void ask(id, "cancel"), UNDO_MS);
  const undo = () => {
    clearTimeout(timer);
    dismiss(toast);
  };
  const action = { label: "Undo", run: undo };
  const toast = tell({ kind: "note", text: `Cancelling ${title} …`, action });
}
