/** The public pages: shares, and the commons with listed shares as moving tiles. */

import * as api from "../api/client";
import type { Share } from "../api/types";
import { useFetched, useRunDetail } from "../store/fetch";
import { useStore } from "../store/store";
import { count, dateTime, shortId } from "../ui/format";
import { FilesCard } from "../run/FilesCard";
import { Loading, NotFound, Page, useTitle, Empty } from "../ui/Page";
import { lazy } from "../ui/lazy";
import { TrustBadge } from "../ui/TrustBadge";
import { isLoopback } from "../publish/Unreachable";
import { Facts } from "../ui/Facts";
import { TakeAway } from "./TakeAway";
import { factsOf } from "../publish/fields";
import { text } from "./text";
import { decodePoses } from "../decode/poses";
import { usePages } from "../store/paging";
import { usePolled } from "../store/polling";
import { SwimmingBody } from "../replay/SwimmingBody";
import "./shares.css";

const CreatureView = lazy(async () => (await import("../creature/CreaturePage")).CreatureView, "section");
const ArchiveRun = lazy(async () => (await import("../run/ArchiveRun")).ArchiveRun, "section");

interface Props {
  slug: string;
  /** A creature of a shared archive. */
  sha: string | null;
  query: URLSearchParams;
}

export function SharedPage({ slug, sha, query }: Props) {
  const { value: share, error } = useFetched(() => api.readShare(slug), [slug]);
  useTitle(share && share.title);
  if (!share && error) {
    return (
      <main>
        <NotFound what={text.notShared} reason={error} />
      </main>
    );
  }
  if (!share) return <Page loading />;
  const creature = sha ?? share.creature;
  const [title, id] = headingOf(share, creature, sha !== null);
  return (
    <Page
      title={[title, " ", id && <code>{id}</code>]}
      actions={creature && <SharedVerdict key={creature} sha={creature} />}
      crumbs={share.run && sha ? [[`/s/${slug}`, share.title]] : undefined}
    >
      <Terms share={share} />
      {creature && <SharedCreature key={creature} {...{ share, query }} id={creature} />}
      {share.run && !sha && <SharedArchive {...{ share, query }} id={share.run} />}
    </Page>
  );
}

function SharedVerdict({ sha }: { sha: string }) {
  const { value: verdict } = useFetched(() => api.readVerdict(sha), [sha]);
  return verdict && <TrustBadge trusted={verdict.trusted} />;
}

const LICENCE_URLS: Record<string, string> = {
  "CC-BY-4.0": "https://creativecommons.org/licenses/by/4.0/",
  "CC-BY-SA-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
  "CC-BY-NC-4.0": "https://creativecommons.org/licenses/by-nc/4.0/",
  "CC0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
};

/** Title and id of the page; the title of an untitled share contains the id already. */
export function headingOf({ run, title }: Share, creature: string | null, inside: boolean) {
  const heading = run && inside ? text.creature : title;
  const id = creature && shortId(creature);
  return [heading, id && heading.includes(id) ? null : id] as const;
}

function Terms({ share }: { share: Share }) {
  const { credit, licence, expires_at, created_at } = share;
  const url = LICENCE_URLS[licence];
  const terms = url && (
    <a href={url} target="_blank" rel="noreferrer license">
      {licence}
    </a>
  );
  return (
    <Facts
      kind="facts terms"
      of={[
        credit.length > 0 && [text.credit, credit.join(", ")],
        ...factsOf(share),
        [text.licence, terms ?? licence],
        [text.shared, dateTime(created_at)],
        expires_at ? [text.until, dateTime(expires_at)] : null,
      ]}
    />
  );
}

type PartProps = Pick<Props, "query"> & { share: Share; id: string };

function SharedCreature({ share, id, query }: PartProps) {
  const { value: creature, error } = useFetched(() => api.readCreature(id), [id]);
  if (error) return <p class="banner wrong">{error}</p>;
  if (!creature) return <Loading />;
  const address = share.creature ? share.url : `${share.url}/creatures/${id}`;
  return (
    <>
      <CreatureView
        {...{ creature, query }}
        title={share.title}
        address={isLoopback(address) ? null : address}
      />
      <TakeAway {...{ share, address }} sha={id} />
    </>
  );
}

function SharedArchive({ share, id, query }: PartProps) {
  const { error } = useRunDetail(id);
  const run = useStore((state) => state.runs.get(id));
  const detail = useStore((state) => state.details.get(id));
  if (!run) {
    return error ? <p class="banner wrong">{error}</p> : <Loading />;
  }
  return (
    <>
      <ArchiveRun {...{ run, detail, query }} />
      <FilesCard run={run} about={text.filesAbout(count(share.generation ?? 0), run.version, run.device)} />
      <TakeAway share={share} address={share.url} sha={null} />
    </>
  );
}

export function CommonsPage() {
  const { items: shares, error, more } = usePages(api.readCommons, ({ slug }) => slug);
  useTitle(text.commons);
  return (
    <Page title={text.commons} error={error} loading={!shares}>
      {shares?.length === 0 && <Empty title={text.nothingListed} hint={text.nothingListedHint} />}
      <ul class="commons">
        {shares?.map((share) => (
          <li key={share.slug}>
            <Tile share={share} />
          </li>
        ))}
      </ul>
      {more && <button onClick={more}>{text.showMore}</button>}
    </Page>
  );
}

function Tile({ share }: { share: Share }) {
  // Without a pose stream the tile stays empty; the page of the share shows the error.
  const { value: stream } = usePolled(async () => decoded(await api.readCover(share)), [share.slug]);
  return (
    <a class="commons-tile card" href={`/s/${share.slug}`} target="_self">
      <SwimmingBody stream={stream} />
      <strong>{share.title}</strong>
      <span class="quiet small">
        {share.run ? text.archive(share.generation) : text.creature}
        {share.credit.length > 0 && ` · ${share.credit.join(", ")}`}
      </span>
      <span class="quiet small licence">{share.licence.slice(0, 60)}</span>
    </a>
  );
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodePoses(bytes);
