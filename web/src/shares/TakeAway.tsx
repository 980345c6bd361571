/** How a share lives on elsewhere: open it in one's own installation, run it, cite it. */

import type { Share } from "../api/types";
import { importPage } from "../api/foreign";
import { copyText } from "../ui/clipboard";
import { Card } from "../ui/Page";
import { bibtex, citation } from "./citation";
import { text } from "./text";

/** The page of an installation on the visitor's own machine. */
const OWN = "http://127.0.0.1:8000";

/** `address` is that of the page; `sha` its creature, null for an archive. */
export function TakeAway({ share, address, sha }: { share: Share; address: string; sha: string | null }) {
  const cited = { ...share, url: address, sha };
  const commands = sha ? text.importCommands(address) : text.evolveCommands(address);
  return (
    <div class="take-away">
      <Card id="import" title={text.ownTitle} actions={<OpenOwn address={address} />}>
        <p class="small">{text.ownAbout}</p>
        <Copied
          title={sha ? text.runTitle : text.runArchiveTitle}
          content={commands}
          note={text.commandsCopied}
        />
      </Card>
      <Card id="cite" title={text.cite}>
        <Copied title={text.citation} content={citation(cited)} note={text.citationCopied} />
        <Copied title={text.bibtex} content={bibtex(cited)} note={text.bibtexCopied} />
      </Card>
    </div>
  );
}

function OpenOwn({ address }: { address: string }) {
  return (
    <a class="button primary" href={OWN + importPage(address)} target="_blank" rel="noreferrer">
      {text.openOwn}
    </a>
  );
}

function Copied({ title, content, note }: { title: string; content: string; note: string }) {
  return (
    <figure class="copied">
      <figcaption>
        {title}
        <button class="slim" aria-label={text.copyOf(title)} onClick={() => void copyText(content, note)}>
          {text.copy}
        </button>
      </figcaption>
      <pre class="command" tabIndex={0}>
        {content}
      </pre>
    </figure>
  );
}
