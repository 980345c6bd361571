/** What people have published for everybody to find, moving. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Share } from "../api/types";
import { type Motion, decodeMotion } from "../decode/motion";
import { usePages } from "../store/paging";
import { poll } from "../store/polling";
import { SwimmingBody } from "../replay/SwimmingBody";
import "./shares.css";

export function CommonsPage() {
  const { items: shares, error, more } = usePages(api.readCommons, ({ slug }) => slug);
  useEffect(() => {
    document.title = "Commons · Microcosmos";
  }, []);
  return (
    <main>
      <header class="page-head">
        <h1>Commons</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!shares && !error && <p class="quiet loading">Loading …</p>}
      {shares?.length === 0 && (
        <section class="empty card">
          <h2>Nothing is listed yet</h2>
          <p>Publish a creature from its page, or an archive from its run’s, and choose to list it.</p>
        </section>
      )}
      <ul class="commons">
        {shares?.map((share) => (
          <li key={share.slug}>
            <Tile share={share} />
          </li>
        ))}
      </ul>
      {more && <button onClick={more}>Show more</button>}
    </main>
  );
}

function Tile({ share }: { share: Share }) {
  const [motion, setMotion] = useState<Motion | null>(null);
  useEffect(() => {
    const silent = () => {}; // It stays still; its own page says what is wrong.
    return poll(async () => decoded(await api.readCover(share)), {
      value: setMotion,
      note: silent,
      error: silent,
    });
  }, [share.slug]);
  return (
    <a class="commons-tile card" href={`/s/${share.slug}`} target="_self">
      <SwimmingBody motion={motion} />
      <strong>{share.title}</strong>
      <span class="quiet small">
        {share.run ? `Archive, generation ${share.generation}` : "Creature"}
        {share.credit.length > 0 && ` · ${share.credit.join(", ")}`}
      </span>
      <span class="quiet small licence">{share.licence.slice(0, 60)}</span>
    </a>
  );
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodeMotion(bytes);
