/** Downloads of a creature; films are rendered on request. */

import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import {
  type PictureFormat,
  renderingReady,
  downloadFile,
  creatureFileUrl,
  creatureH5Url,
  pictureUrl,
  posesUrl,
  saveFile,
} from "../api/files";
import { sharedSlug } from "../api/address";
import { poll } from "../store/polling";
import { showFailure, showToast } from "../store/toasts";
import { copyText } from "../ui/clipboard";
import { FileLink } from "../ui/links";
import { text } from "./text";
import type { AboutCreature } from "../offline/page";
import { useLeaving } from "../ui/forms";
import { bytes, shortId } from "../ui/format";

const KINDS: [PictureFormat, string][] = [
  ["strip.png", "PNG"],
  ["film.gif", "GIF"],
  ["film.mp4", "MP4"],
];

export function Downloads({ sha, children }: { sha: string; children: ComponentChildren }) {
  return (
    <p class="links pictures" role="group" aria-label={text.download}>
      <span class="quiet small">{text.download}</span>
      {!sharedSlug && (
        <button onClick={() => void copyText(`${location.origin}/creatures/${sha}`, text.linkCopied)}>
          {text.copyLink}
        </button>
      )}
      <FileLink url={creatureFileUrl(sha)} name="JSON" title={text.jsonAbout} />
      <FileLink url={creatureH5Url(sha)} name="HDF5" />
      {(sharedSlug ? [] : KINDS).map(([kind, title]) => (
        <Download key={kind} url={pictureUrl(sha, kind)} title={title} />
      ))}
      <Download url={posesUrl(sha, "csv")} title={text.motionCsv} />
      <Download url={posesUrl(sha, "npz")} title={text.motionNumpy} />
      {children}
    </p>
  );
}

/** A button that waits for the rendering and then saves it. */
function Download({ url, title }: { url: string; title: string }) {
  const [busy, setBusy] = useState(false);
  useEffect(() => {
    if (!busy) return;
    return poll(() => renderingReady(url), {
      value: () => {
        setBusy(false);
        downloadFile(url).catch(showFailure);
      },
      note: () => {},
      error: (message) => {
        setBusy(false);
        showToast({ kind: "wrong", text: message });
      },
    });
  }, [busy, url]);
  return (
    <button disabled={busy} onClick={() => setBusy(true)}>
      {busy ? text.rendering(title) : title}
    </button>
  );
}

/** The button that saves a creature as a page that needs no network. */
export function SavePage(about: AboutCreature) {
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

const made = async (about: AboutCreature, signal: AbortSignal): Promise<Blob> =>
  (await import("../offline/page")).pageOf(about, signal);
