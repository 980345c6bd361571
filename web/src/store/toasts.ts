/** Short notes at the edge of the page, some with an undo button. */

import { messageOf } from "../api/problem";
import { currentState, update } from "./store";
import { text } from "./text";

export interface Toast {
  id: number;
  text: string;
  kind: "note" | "wrong";
  action?: { label: string; run: () => void };
}

const SHOWN_MS = { note: 4000, wrong: 9000 };

let count = 0;

export const dismissToast = (id: number): void =>
  update((state) => ({ ...state, toasts: state.toasts.filter((toast) => toast.id !== id) }));

/** Show a note for a while; return the id that dismisses it. */
export function showToast(toast: Omit<Toast, "id">): number {
  const id = ++count;
  update((state) => ({ ...state, toasts: [...state.toasts, { ...toast, id }] }));
  setTimeout(() => dismissToast(id), SHOWN_MS[toast.kind]);
  return id;
}

export function showFailure(error: unknown): void {
  showToast({ kind: "wrong", text: messageOf(error) });
}

/** Await a request; after an error, show it and return null. */
export async function orShowError<T>(request: Promise<T>): Promise<T | null> {
  try {
    return await request;
  } catch (error) {
    showFailure(error);
    return null;
  }
}

/** Show a note with an undo button; return the id of the note. */
export function offerUndo(note: string, undo: () => void): number {
  const run = () => {
    dismissToast(toast);
    undo();
  };
  const toast = showToast({ kind: "note", text: note, action: { label: text.undo, run } });
  return toast;
}

/** Ctrl+Z presses the newest undo button, which the Tab key reaches too late. */
export function undoLatest(event: KeyboardEvent): void {
  const field = (event.target as Element).closest("input:not([type=checkbox]), textarea, select");
  if (event.key !== "z" || !(event.ctrlKey || event.metaKey) || event.shiftKey || field) return;
  const last = currentState().toasts.findLast(({ action }) => action);
  if (!last) return;
  event.preventDefault();
  last.action!.run();
}
