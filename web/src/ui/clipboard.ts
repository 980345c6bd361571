/** Copy text to the clipboard, with a note on success or failure. */

import { orShowError, showToast } from "../store/toasts";
import { text } from "./text";

export async function copyText(content: string, note: string): Promise<void> {
  const copied = await orShowError(writeClipboard(content).then(() => true));
  if (copied) showToast({ kind: "note", text: note });
}

/** Over plain HTTP, browsers only copy a selection. */
async function writeClipboard(content: string): Promise<void> {
  if (navigator.clipboard) return navigator.clipboard.writeText(content);
  const focused = document.activeElement as HTMLElement | null;
  const area = document.createElement("textarea");
  area.value = content;
  area.style.cssText = "position: fixed; top: 0; opacity: 0";
  (focused?.closest("dialog") ?? document.body).append(area); // Outside an open dialog nothing can be selected.
  area.select();
  const copied = document.execCommand("copy");
  area.remove();
  focused?.focus({ preventScroll: true });
  if (!copied) throw new Error(text.noClipboard);
}
