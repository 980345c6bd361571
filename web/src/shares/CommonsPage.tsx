/** The commons: listed shares as moving tiles. */

import * as api from "../api/client";
import type { Share } from "../api/types";
import { decodeMotion } from "../decode/replay";
import { usePages } from "../store/paging";
import { usePolled } from "../store/polling";
import { Empty, Page, useTitle } from "../ui/Page";
import { SwimmingBody } from "../replay/SwimmingBody";
import { text } from "./text";
import "./shares.css";

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
  // Without a motion the tile stays empty; the page of the share shows the error.
  const { value: motion } = usePolled(async () => decoded(await api.readCover(share)), [share.slug]);
  return (
    <a class="commons-tile card" href={`/s/${share.slug}`} target="_self">
      <SwimmingBody motion={motion} />
      <strong>{share.title}</strong>
      <span class="quiet small">
        {share.run ? text.archive(share.generation) : text.creature}
        {share.credit.length > 0 && ` · ${share.credit.join(", ")}`}
      </span>
      <span class="quiet small licence">{share.licence.slice(0, 60)}</span>
    </a>
  );
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodeMotion(bytes);
