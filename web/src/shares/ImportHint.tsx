/** How to bring a shared creature to an installation of one's own. */

import { creatureFileUrl } from "../api/urls";
import type { Share } from "../api/types";
import { copyText } from "../ui/clipboard";

export function ImportHint({ share, sha }: { share: Share; sha: string }) {
  const file = new URL(creatureFileUrl(sha), share.url).href;
  const command = `curl -sf '${file}' | curl -sf -H 'Content-Type: application/json' --data-binary @- http://127.0.0.1:8000/api/v1/creatures`;
  return (
    <section class="card import-hint" aria-labelledby="taking-title">
      <div class="card-head">
        <h2 id="taking-title">Import it into your own Microcosmos</h2>
        <span class="spring" />
        <button onClick={() => void copyText(command, "Command copied.")}>Copy the command</button>
      </div>
      <p>
        Download the JSON file above and drop it on any page of your Microcosmos, or run this where it runs.
        Name, ancestors, licence and credit come along, and it can be measured again there.
      </p>
      <pre class="command" tabIndex={0}>
        {command}
      </pre>
    </section>
  );
}
