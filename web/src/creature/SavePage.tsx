/** The button that saves a creature as a page that needs no network. */

import { useState } from "preact/hooks";
import { saveFile } from "../api/files";
import type { About } from "../offline/page";
import { showFailure, showToast } from "../store/toasts";
import { useLeaving } from "../ui/forms";
import { bytes, shortId } from "../ui/format";
import { text } from "./text";

export function SavePage(about: About) {
  const [busy, setBusy] = useState(false);
  const leaving = useLeaving();
  const save = async () => {
    setBusy(true);
    try {
      const page = await made(about, leaving);
      saveFile(page, `creature-${shortId(about.creature.sha256)}.html`);
      showToast({ kind: "note", text: text.savedPage(bytes(page.size)) });
    } catch (error) {
      if (!leaving.aborted) showFailure(error);
    }
    setBusy(false);
  };
  return (
    <button disabled={busy} onClick={() => void save()} title={text.savePageAbout}>
      {busy ? text.savingPage : text.savePage}
    </button>
  );
}

const made = async (about: About, signal: AbortSignal): Promise<Blob> =>
  (await import("../offline/page")).pageOf(about, signal);
