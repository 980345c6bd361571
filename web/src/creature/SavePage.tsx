/** The button that saves a creature as a page that needs no network. */

import { useState } from "preact/hooks";
import { saveFile } from "../api/files";
import type { About } from "../offline/page";
import { orShowError, showToast } from "../store/toasts";
import { bytes, shortId } from "../ui/format";
import { text } from "./text";

export function SavePage(about: About) {
  const [busy, setBusy] = useState(false);
  const save = async () => {
    setBusy(true);
    const page = await orShowError(made(about));
    setBusy(false);
    if (!page) return;
    saveFile(page, `creature-${shortId(about.creature.sha256)}.html`);
    showToast({ kind: "note", text: text.savedPage(bytes(page.size)) });
  };
  return (
    <button disabled={busy} onClick={() => void save()} title={text.savePageAbout}>
      {busy ? text.savingPage : text.savePage}
    </button>
  );
}

const made = async (about: About): Promise<Blob> => (await import("../offline/page")).pageOf(about);
