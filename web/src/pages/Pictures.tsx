/** Films and pictures of a creature, made when somebody wants them. */

import { useEffect, useState } from "preact/hooks";
import { type Picture, pictureUrl, proveRendering } from "../api/client";
import { poll } from "../live/polling";
import { tell } from "../live/toasts";
import { save } from "./FileLink";

const KINDS: [Picture, string][] = [
  ["film.mp4", "MP4"],
  ["film.gif", "GIF"],
  ["strip.png", "PNG strip"],
];

export function Pictures({ sha }: { sha: string }) {
  return (
    <p class="links pictures">
      <span class="quiet small">Keep it as</span>
      {KINDS.map(([kind, title]) => (
        <Download key={kind} url={pictureUrl(sha, kind)} title={title} />
      ))}
    </p>
  );
}

/** A button that waits for the rendering and then saves it. */
function Download({ url, title }: { url: string; title: string }) {
  const [busy, setBusy] = useState(false);
  useEffect(() => {
    if (!busy) return;
    return poll(() => proveRendering(url), {
      value: () => {
        setBusy(false);
        save(url);
      },
      note: () => {},
      error: (text) => {
        setBusy(false);
        tell({ kind: "wrong", text });
      },
    });
  }, [busy, url]);
  return (
    <button disabled={busy} onClick={() => setBusy(true)}>
      {busy ? `Rendering ${title} …` : title}
    </button>
  );
}
