/** The list of shares, with revoking. */

import * as api from "../api/client";
import type { Share } from "../api/types";
import { useRefusal } from "../store/principal";
import { usePages } from "../store/paging";
import { showError, showToast } from "../store/toasts";
import { moment } from "../ui/format";
import { ConfirmButton } from "../ui/ConfirmButton";
import { copyText } from "../ui/clipboard";
import { text } from "./text";
import "./shares.css";

export function SharesPage() {
  const refusal = useRefusal();
  const { items: shares, error, more, replace: put } = usePages(api.readShares, ({ slug }) => slug);
  return (
    <main>
      <header class="page-head">
        <h1>{text.shares}</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!shares && !error && <p class="quiet loading">{text.loading}</p>}
      {shares?.length === 0 && (
        <section class="empty card">
          <h2>{text.nothingShared}</h2>
          <p>{refusal ?? text.nothingSharedHint}</p>
        </section>
      )}
      {shares && shares.length > 0 && (
        <section class="card scroll" aria-label={text.published} tabIndex={0}>
          <table class="plain-table shares">
            <thead>
              <tr>
                <th scope="col">{text.title}</th>
                <th scope="col">{text.content}</th>
                <th scope="col">{text.licence}</th>
                <th scope="col">{text.publishedOn}</th>
                <th scope="col">{text.expires}</th>
                <th scope="col">{text.visibleTo}</th>
                <th scope="col">
                  <span class="unseen">{text.actions}</span>
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
      {more && <button onClick={more}>{text.showMore}</button>}
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
      <td data-label={text.content}>
        {run ? (
          <a href={`/runs/${run}`}>{text.archiveOf(generation)}</a>
        ) : (
          <a href={`/creatures/${creature}`}>{text.creatureLink}</a>
        )}
      </td>
      <td data-label={text.licence}>{licence.slice(0, 40)}</td>
      <td data-label={text.publishedOn}>{moment(share.created_at)}</td>
      <td data-label={text.expires}>{share.expires_at ? moment(share.expires_at) : text.never}</td>
      <td data-label={text.visibleTo}>
        {live ? (share.listed ? text.everybody : text.linkHolders) : text.nobody(state)}
      </td>
      <td>
        {live && (
          <span class="actions">
            <button
              class="slim"
              aria-label={text.copyLinkOf(title)}
              onClick={() => void copyText(share.url, text.linkCopied)}
            >
              {text.copyLink}
            </button>
            <ConfirmButton verb={text.revoke} what={title} onConfirm={() => revoke(share, onChange)} />
          </span>
        )}
      </td>
    </tr>
  );
}

async function revoke(share: Share, onChange: (share: Share) => void): Promise<void> {
  try {
    onChange(await api.revoke(share.slug));
    showToast({ kind: "note", text: text.revoked(share.title) });
  } catch (error) {
    showError(error);
  }
}
