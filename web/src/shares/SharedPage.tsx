/** The public page of a share: a creature, or an archive and its elites. */

import { useEffect } from "preact/hooks";
import * as api from "../api/client";
import { archiveUrl } from "../api/urls";
import type { Share } from "../api/types";
import { useFetched, useRunDetail } from "../store/fetch";
import { useStore } from "../store/store";
import { count, moment, short } from "../ui/format";
import { NotFound } from "../ui/NotFound";
import { ArchiveRun } from "../run/ArchiveRun";
import { CreatureView } from "../creature/CreaturePage";
import { FileLink } from "../ui/FileLink";
import { ImportHint } from "./ImportHint";
import { text } from "./text";
import "./shares.css";

interface Props {
  slug: string;
  /** One of the creatures of an archive. */
  sha: string | null;
  query: URLSearchParams;
}

export function SharedPage({ slug, sha, query }: Props) {
  const { value: share, error } = useFetched(() => api.readShare(slug), [slug]);
  useEffect(() => {
    if (share) document.title = text.pageTitle(share.title);
  }, [share]);
  if (!share) {
    return (
      <main>
        {error ? (
          <NotFound what={text.notShared} reason={error} />
        ) : (
          <p class="quiet loading">{text.loading}</p>
        )}
      </main>
    );
  }
  const creature = sha ?? share.creature;
  const [title, id] = headingOf(share, creature, sha !== null);
  return (
    <main>
      {share.run && sha && (
        <nav class="crumbs" aria-label={text.breadcrumbs}>
          <a href={`/s/${slug}`}>{share.title}</a>
        </nav>
      )}
      <header class="page-head">
        <h1>
          {title} {id && <code>{id}</code>}
        </h1>
      </header>
      <Terms share={share} />
      {creature && <SharedCreature key={creature} {...{ share, query }} sha={creature} />}
      {share.run && !sha && <SharedArchive {...{ share, query }} id={share.run} />}
    </main>
  );
}

const LICENCE_URLS: Record<string, string> = {
  "CC-BY-4.0": "https://creativecommons.org/licenses/by/4.0/",
  "CC-BY-SA-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
  "CC-BY-NC-4.0": "https://creativecommons.org/licenses/by-nc/4.0/",
  "CC0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
};

/** Title and id of what is shown; the title of an untitled share contains the id already. */
export function headingOf({ run, title }: Share, creature: string | null, inside: boolean) {
  const heading = run && inside ? text.creature : title;
  const id = creature && short(creature);
  return [heading, id && heading.includes(id) ? null : id] as const;
}

/** Credit, licence and expiry of a share. */
function Terms({ share: { credit, licence, expires_at, created_at } }: { share: Share }) {
  const url = LICENCE_URLS[licence];
  return (
    <dl class="facts terms">
      {credit.length > 0 && <Term name={text.credit}>{credit.join(", ")}</Term>}
      <Term name={text.licence}>
        {url ? (
          <a href={url} target="_blank" rel="noreferrer license">
            {licence}
          </a>
        ) : (
          licence
        )}
      </Term>
      <Term name={text.shared}>{moment(created_at)}</Term>
      {expires_at && <Term name={text.until}>{moment(expires_at)}</Term>}
    </dl>
  );
}

function Term({ name, children }: { name: string; children: preact.ComponentChildren }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </div>
  );
}

interface CreatureProps {
  share: Share;
  sha: string;
  query: URLSearchParams;
}

function SharedCreature({ share, sha, query }: CreatureProps) {
  const { value: creature, error } = useFetched(() => api.readCreature(sha), [sha]);
  if (error) return <p class="banner wrong">{error}</p>;
  if (!creature) return <p class="quiet loading">{text.loadingCreature}</p>;
  return (
    <>
      <CreatureView {...{ creature, query }} />
      <ImportHint share={share} sha={sha} />
    </>
  );
}

interface ArchiveProps {
  share: Share;
  id: string;
  query: URLSearchParams;
}

function SharedArchive({ share, id, query }: ArchiveProps) {
  const { error } = useRunDetail(id);
  const run = useStore((state) => state.runs.get(id));
  const detail = useStore((state) => state.details.get(id));
  if (!run) {
    return error ? <p class="banner wrong">{error}</p> : <p class="quiet loading">{text.loading}</p>;
  }
  return (
    <>
      <ArchiveRun {...{ run, detail, query }} />
      <section class="card" aria-labelledby="files-title">
        <h2 id="files-title">{text.files}</h2>
        <p class="links">
          <FileLink url={archiveUrl(id, "h5")} name="archive.h5" />
          <FileLink url={archiveUrl(id, "csv")} name="archive.csv" />
        </p>
        <p class="quiet">{text.filesAbout(count(share.generation ?? 0), run.version, run.device)}</p>
      </section>
    </>
  );
}
