/** Use of a share elsewhere: open it in one's own installation, run it, embed it, cite it. */

import type { Share } from "../api/types";
import { importPage } from "../api/address";
import { copyText } from "../ui/clipboard";
import { Card } from "../ui/Page";
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

/** A creature is cited with its SHA-256, which names it everywhere. */
type Cited = Pick<Share, "title" | "credit" | "url" | "created_at" | "generation"> & {
  sha: string | null;
};

const yearOf = ({ created_at }: Cited) => created_at.slice(0, 4);
const namesOf = ({ credit }: Cited) => (credit.length > 0 ? credit : [text.anonymous]);
const kindOf = ({ sha, generation }: Cited) =>
  sha ? text.citedCreature(sha) : text.citedArchive(generation);

export const citation = (share: Cited) =>
  `${namesOf(share).join(", ")} (${yearOf(share)}). ${share.title}. ${kindOf(share)}. ${share.url}`;

/** A name is braced: BibTeX would take it apart. */
export function bibtex(share: Cited): string {
  const names = namesOf(share).map((name) => `{${escaped(name)}}`);
  const fields = {
    author: names.join(" and "),
    title: `{${escaped(share.title)}}`,
    year: yearOf(share),
    howpublished: `\\url{${share.url}}`,
    note: escaped(kindOf(share)),
  };
  const key = `microcosmos-${(share.sha ?? share.url.split("/").pop()!).slice(0, 8)}`;
  const lines = Object.entries(fields).map(([name, value]) => `  ${name} = {${value}},`);
  return [`@misc{${key},`, ...lines, "}"].join("\n");
}

const SPECIAL: Record<string, string> = {
  "\\": "\\textbackslash{}",
  "~": "\\textasciitilde{}",
  "^": "\\textasciicircum{}",
};

const escaped = (words: string) => words.replace(/[\\~^#$%&_{}]/g, (sign) => SPECIAL[sign] ?? `\\${sign}`);

const [WIDTH, HEIGHT] = [480, 560];

/** `sha` is a creature of a shared archive; without one its best is shown. */
export function embedCode({ url, title, run }: Share, sha: string | null): string {
  const address = `${url}/embed${run && sha ? `?creature=${sha}` : ""}`;
  return `<iframe src="${address}" title="${quoted(title)}" width="${WIDTH}" height="${HEIGHT}" style="border: 0; max-width: 100%" loading="lazy"></iframe>`;
}

const quoted = (words: string) =>
  words.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");
