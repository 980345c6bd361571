/** How to import a shared creature into another installation. */

import { SHARE_HEADER } from "../api/address";
import { creatureFileUrl } from "../api/urls";
import type { Share } from "../api/types";
import { copyText } from "../ui/clipboard";
import { text } from "./text";

export function ImportHint({ share, sha }: { share: Share; sha: string }) {
  const file = new URL(creatureFileUrl(sha), share.url).href;
  const command = `curl -sf -H '${SHARE_HEADER}: ${share.slug}' '${file}' | curl -sf -H 'Content-Type: application/json' --data-binary @- http://127.0.0.1:8000/api/v1/creatures`;
  return (
    <section class="card import-hint" aria-labelledby="taking-title">
      <div class="card-head">
        <h2 id="taking-title">{text.importTitle}</h2>
        <span class="spring" />
        <button onClick={() => void copyText(command, text.commandCopied)}>{text.copyCommand}</button>
      </div>
      <p>{text.importHint}</p>
      <pre class="command" tabIndex={0}>
        {command}
      </pre>
    </section>
  );
}
