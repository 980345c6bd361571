/** Commands for a run. Cancelling is delayed so that it can be undone. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import { applyResponse } from "./store";
import { dismissToast, showToast } from "./toasts";
import { text } from "./text";

const UNDO_MS = 4000;

export async function sendCommand(id: string, verb: api.RunCommand): Promise<void> {
  try {
    await applyResponse("change", api.commandRun(id, verb));
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
  }
}

export function cancelWithUndo(id: string, title: string): void {
  const timer = setTimeout(() => void sendCommand(id, "cancel"), UNDO_MS);
  const undo = () => {
    clearTimeout(timer);
    dismissToast(toast);
  };
  const action = { label: text.undo, run: undo };
  const toast = showToast({ kind: "note", text: text.cancelling(title), action });
}
