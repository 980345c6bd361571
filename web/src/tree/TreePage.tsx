/** The pages of the tree of life: of a run, of a creature across runs, and of a shared creature. */

import { useEffect } from "preact/hooks";
import * as api from "../api/client";
import { hasArchive, useExperiments, useFetched } from "../store/fetch";
import { useThrottled } from "../store/polling";
import { applyResponse, retain, useStore } from "../store/store";
import { shortId, titleOf } from "../ui/format";
import { Empty, Loading, NotFound, Page, reasonOf, useTitle } from "../ui/Page";
import { TreeView } from "./TreeView";
import { text } from "./text";
import "./tree.css";

interface Props {
  id: string;
  query: URLSearchParams;
}

/** Interval of updates: the tree of a run that goes on grows. */
const REFRESH_MS = 30_000;

export function RunTreePage({ id, query }: Props) {
  const { error } = useFetched(() => applyResponse("response", api.readRun(id)), [id]);
  const run = useStore((state) => state.runs.get(id));
  useEffect(() => retain([id]), [id]);
  const experiments = useExperiments().value ?? [];
  const title = run ? titleOf(run, experiments) : text.run;
  useTitle(`${text.title}, ${title}`);
  if (!run) {
    return <Page loading={!error}>{error && <NotFound what={text.run} reason={error} id={id} />}</Page>;
  }
  const crumbs = [
    ["/", text.runs],
    [`/runs/${id}`, title],
  ] as const;
  return (
    <Page crumbs={[...crumbs]}>
      <Title id={id} />
      {hasArchive(run) ? (
        <RunTree id={id} generation={run.generation} query={query} />
      ) : (
        <Empty title={text.noArchive} hint={text.noArchiveAbout} />
      )}
    </Page>
  );
}

export const Title = ({ id }: { id: string }) => (
  <header class="page-head">
    <h1>
      {text.title} <code>{shortId(id)}</code>
    </h1>
  </header>
);

function RunTree({ id, generation, query }: Props & { generation: number }) {
  const slow = useThrottled(generation, REFRESH_MS);
  const { value, error } = useFetched(() => api.readRunPhylogeny(id), [id, slow]);
  return <LoadedTree of={`/runs/${id}`} {...{ value, error, query }} isEmpty={generation === 0} />;
}

export function CreatureTreePage({ id: sha, query }: Props) {
  const { value, error } = useFetched(() => api.readCreaturePhylogeny(sha), [sha]);
  useTitle(`${text.title}, ${shortId(sha)}`);
  const crumbs = [
    ["/", text.runs],
    [`/creatures/${sha}`, `${text.creature} ${shortId(sha)}`],
  ] as const;
  return (
    <Page crumbs={[...crumbs]}>
      <Title id={sha} />
      <LoadedTree
        of={`/creatures/${sha}`}
        self={sha}
        {...{ query, value }}
        error={error && reasonOf(error, sha)}
      />
    </Page>
  );
}

interface LoadedProps {
  of: string;
  self?: string;
  value: ArrayBuffer | null;
  error: string | null;
  query: URLSearchParams;
  isEmpty?: boolean;
}

export function LoadedTree({ of, self, value, error, query, isEmpty = false }: LoadedProps) {
  if (isEmpty) return <Empty title={text.empty} hint={text.emptyAbout} />;
  return (
    <>
      {error && (
        <p class="banner wrong" role="alert">
          {error}
        </p>
      )}
      {!value && !error && <Loading />}
      {value && <TreeView buffer={value} {...{ of, self, query }} />}
    </>
  );
}

interface SharedTreePageProps {
  slug: string;
  /** A creature of a shared archive. */
  sha: string | null;
  query: URLSearchParams;
}

export function SharedTreePage({ slug, sha, query }: SharedTreePageProps) {
  const { value, error } = useFetched(async () => {
    const share = await api.readShare(slug);
    const self = sha ?? share.cover;
    return { share, self, tree: await api.readCreaturePhylogeny(self) };
  }, [slug, sha]);
  useTitle(value && `${text.title}, ${value.share.title}`);
  if (!value) {
    return <Page loading={!error}>{error && <NotFound what={text.title} reason={error} />}</Page>;
  }
  const { share, self, tree } = value;
  return (
    <Page crumbs={[[`/s/${slug}${sha ? `/creatures/${sha}` : ""}`, share.title]]}>
      <Title id={self} />
      <LoadedTree of={`/creatures/${self}`} value={tree} {...{ self, query, error }} />
    </Page>
  );
}
