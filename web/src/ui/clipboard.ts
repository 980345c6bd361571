/** Text into the clipboard, and a word on whether it came there. */

import { messageOf } from "../api/problem";
import { showToast } from "../store/toasts";

export async function copyText(text: string, note: string): Promise<void> {
  try {
    await writeClipboard(text);
    showToast({ kind: "note", text: note });
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
  }
}

/** Over plain HTTP browsers have no clipboard but for what is selected. */
async function writeClipboard(text: string): Promise<void> {
  if (navigator.clipboard) return navigator.clipboard.writeText(text);
  const focused = document.activeElement as HTMLElement | null;
  const area = document.createElement("textarea");
  area.value = text;
  area.style.cssText = "position: fixed; top: 0; opacity: 0";
  (focused?.closest("dialog") ?? document.body).append(area); // Beside a dialog nothing can be selected.
  area.select();
  const copied = document.execCommand("copy");
  area.remove();
  focused?.focus({ preventScroll: true });
  if (!copied) throw new Error("The browser keeps pages that came over HTTP from its clipboard.");
}
