/** Short notes at the edge of the page, some with a way back. */

import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { text } from "./text";

export interface Toast {
  id: number;
  text: string;
  kind: "note" | "wrong";
  action?: { label: string; run: () => void };
}

const SHOWN_MS = { note: 4000, wrong: 9000 };

let toasts: readonly Toast[] = [];
let count = 0;
const listeners = new Set<(toasts: readonly Toast[]) => void>();

function change(next: readonly Toast[]): void {
  toasts = next;
  for (const listener of listeners) listener(toasts);
}

export function dismissToast(id: number): void {
  change(toasts.filter((toast) => toast.id !== id));
}

/** Shows a note for a while; answers the id under which it can be dismissed. */
export function showToast(toast: Omit<Toast, "id">): number {
  const id = ++count;
  change([...toasts, { ...toast, id }]);
  setTimeout(() => dismissToast(id), SHOWN_MS[toast.kind]);
  return id;
}

/** Show why something failed. */
export function showFailure(error: unknown): void {
  showToast({ kind: "wrong", text: messageOf(error) });
}

/** Show a note with a button that takes back what was done; return its id. */
export function offerUndo(note: string, undo: () => void): number {
  const run = () => {
    dismissToast(id);
    undo();
  };
  const id = showToast({ kind: "note", text: note, action: { label: text.undo, run } });
  return id;
}

/** The newest way back by Ctrl+Z, which a note at the end of the page would be too short for. */
export function undoLatest(event: KeyboardEvent): void {
  const field = (event.target as Element).closest("input:not([type=checkbox]), textarea, select");
  if (event.key !== "z" || !(event.ctrlKey || event.metaKey) || event.shiftKey || field) return;
  const last = toasts.findLast(({ action }) => action);
  if (!last) return;
  event.preventDefault();
  last.action!.run();
}

export function useToasts(): readonly Toast[] {
  const [shown, setShown] = useState(toasts);
  useEffect(() => {
    listeners.add(setShown);
    return () => void listeners.delete(setShown);
  }, []);
  return shown;
}
