/** How a share lives on elsewhere: open it in one's own installation, run it, cite it. */

import type { Share } from "../api/types";
import { importPage } from "../api/shareAddress";
import { copyText } from "../ui/clipboard";
import { Card } from "../ui/Page";
import { bibtex, citation } from "./citation";
import { embedCode } from "./embedding";
import { text } from "./text";

/** The page of an installation on the visitor's own machine. */
const OWN = "http://127.0.0.1:8000";

/** `address` is that of the page; `sha` its creature, null for an archive. */
export function TakeAway({ share, address, sha }: { share: Share; address: string; sha: string | null }) {
  const cited = { ...share, url: address, sha };
  const commands = sha ? text.importCommands(address) : text.evolveCommands(address);
  return (
    <div class="take-away">
      <div class="stack">
        <Card id="import" title={text.ownTitle} actions={<OpenOwn address={address} />}>
          <p class="small">{text.ownAbout}</p>
          <Copied
            title={sha ? text.runTitle : text.runArchiveTitle}
            content={commands}
            note={text.commandsCopied}
          />
        </Card>
        <Card id="embed" title={text.embed}>
          <Copied
            title={text.embedAbout}
            content={embedCode(share, sha)}
            note={text.embedCopied}
            name={text.copyEmbed}
          />
        </Card>
      </div>
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

interface CopiedProps {
  title: string;
  content: string;
  note: string;
  name?: string;
}

function Copied({ title, content, note, name = text.copy }: CopiedProps) {
  return (
    <figure class="copied">
      <figcaption>
        {title}
        <button
          class="slim"
          aria-label={name === text.copy ? text.copyOf(title) : undefined}
          onClick={() => void copyText(content, note)}
        >
          {name}
        </button>
      </figcaption>
      <pre class="command" tabIndex={0}>
        {content}
      </pre>
    </figure>
  );
}
