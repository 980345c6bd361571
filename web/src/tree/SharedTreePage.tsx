/** The tree of life of a shared creature: its ancestors. */

import * as api from "../api/client";
import { useFetched } from "../store/fetch";
import { NotFound, Page, useTitle } from "../ui/Page";
import { LoadedTree, Title } from "./TreePage";
import { text } from "./text";
import "./tree.css";

interface Props {
  slug: string;
  /** A creature of a shared archive. */
  sha: string | null;
  query: URLSearchParams;
}

export function SharedTreePage({ slug, sha, query }: Props) {
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
