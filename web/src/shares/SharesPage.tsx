/** What was published from here, and taking it back. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Share } from "../api/types";
import { useRefusal } from "../store/principal";
import { usePages } from "../store/paging";
import { showToast } from "../store/toasts";
import { moment } from "../ui/format";
import { ConfirmButton } from "../ui/ConfirmButton";
import { copyText } from "../ui/clipboard";
import "./shares.css";

export function SharesPage() {
  const refusal = useRefusal();
  const { items: shares, error, more, replace: put } = usePages(api.readShares, ({ slug }) => slug);
  return (
    <main>
      <header class="page-head">
        <h1>Shares</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!shares && !error && <p class="quiet loading">Loading …</p>}
      {shares?.length === 0 && (
        <section class="empty card">
          <h2>Nothing is shared</h2>
          <p>{refusal ?? "Publish a creature from its page, or an archive from its run’s."}</p>
        </section>
      )}
      {shares && shares.length > 0 && (
        <section class="card scroll" aria-label="What was published" tabIndex={0}>
          <table class="plain-table shares">
            <thead>
              <tr>
                <th scope="col">Title</th>
                <th scope="col">What</th>
                <th scope="col">Licence</th>
                <th scope="col">Published</th>
                <th scope="col">Expires</th>
                <th scope="col">Seen by</th>
                <th scope="col">
                  <span class="unseen">Actions</span>
                </th>
              </tr>
            </thead>
            <tbody>
              {shares.map((share) => (
                <Row key={share.slug} share={share} onChange={put} />
              ))}
            </tbody>
          </table>
        </section>
      )}
      {more && <button onClick={more}>Show more</button>}
    </main>
  );
}

function Row({ share, onChange }: { share: Share; onChange: (share: Share) => void }) {
  const { slug, title, licence, run, creature, generation, state } = share;
  const live = state === "live";
  return (
    <tr class={live ? "" : "quiet"}>
      <th scope="row">
        {live ? (
          <a href={`/s/${slug}`} target="_blank">
            {title}
          </a>
        ) : (
          title
        )}
      </th>
      <td data-label="What">
        {run ? (
          <a href={`/runs/${run}`}>archive, generation {generation}</a>
        ) : (
          <a href={`/creatures/${creature}`}>creature</a>
        )}
      </td>
      <td data-label="Licence">{licence.slice(0, 40)}</td>
      <td data-label="Published">{moment(share.created_at)}</td>
      <td data-label="Expires">{share.expires_at ? moment(share.expires_at) : "never"}</td>
      <td data-label="Seen by">
        {live ? (share.listed ? "everybody" : "who has the link") : `nobody: ${state}`}
      </td>
      <td>
        {live && (
          <span class="actions">
            <button
              class="slim"
              aria-label={`Copy link of ${title}`}
              onClick={() => void copyText(share.url, "Link copied.")}
            >
              Copy link
            </button>
            <ConfirmButton verb="Revoke" what={title} onConfirm={() => revoke(share, onChange)} />
          </span>
        )}
      </td>
    </tr>
  );
}

async function revoke(share: Share, onChange: (share: Share) => void): Promise<void> {
  try {
    onChange(await api.revoke(share.slug));
    showToast({ kind: "note", text: `${share.title} is not shared any more.` });
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
  }
}
