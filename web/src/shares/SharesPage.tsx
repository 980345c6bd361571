/** The list of shares, with revoking. */

import * as api from "../api/client";
import type { Share } from "../api/types";
import { useRefusal } from "../store/principal";
import { usePages } from "../store/paging";
import { orShowError, showToast } from "../store/toasts";
import { dateTime } from "../ui/format";
import { ConfirmButton } from "../ui/ConfirmButton";
import { Card, Empty, Page } from "../ui/Page";
import { type Column, Table } from "../ui/Table";
import { TrustBadge } from "../ui/TrustBadge";
import { copyText } from "../ui/clipboard";
import { Unreachable, isLoopback } from "../publish/Unreachable";
import { ImportForm } from "./ImportPage";
import { text } from "./text";
import "./shares.css";

export function SharesPage() {
  const refusal = useRefusal();
  const { items: shares, error, more, replace: put } = usePages(api.readShares, ({ slug }) => slug);
  const unreachable = shares?.find(({ state, url }) => state === "live" && isLoopback(url));
  return (
    <Page title={text.shares} error={error} loading={!shares}>
      {unreachable && <Unreachable url={unreachable.url} />}
      {shares?.length === 0 && <Empty title={text.nothingShared} hint={refusal ?? text.nothingSharedHint} />}
      {shares && shares.length > 0 && (
        <section class="card">
          <Table
            label={text.published}
            kind="shares"
            columns={columnsOf(put)}
            rows={shares}
            keyOf={({ slug }) => slug}
            rowKind={({ state }) => (state === "live" ? "" : "quiet")}
          />
        </section>
      )}
      {more && <button onClick={more}>{text.showMore}</button>}
      {!refusal && (
        <Card id="import" title={text.importTitle}>
          <ImportForm address="" />
        </Card>
      )}
    </Page>
  );
}

const columnsOf = (onChange: (share: Share) => void): Column<Share>[] => [
  { title: text.title, cell: (share) => <Title {...share} /> },
  { title: text.content, cell: (share) => <Content {...share} /> },
  { title: text.licence, cell: ({ licence }) => licence.slice(0, 40) },
  { title: text.publishedOn, cell: ({ created_at }) => dateTime(created_at) },
  { title: text.expires, cell: ({ expires_at }) => (expires_at ? dateTime(expires_at) : text.never) },
  { title: text.visibleTo, cell: ({ state, listed }) => text.viewers(state, listed) },
  { title: text.actions, unseen: true, cell: (share) => <Actions share={share} onChange={onChange} /> },
];

function Title({ state, slug, title }: Share) {
  if (state !== "live") return <>{title}</>;
  return (
    <a href={`/s/${slug}`} target="_blank">
      {title}
    </a>
  );
}

function Content({ run, creature, generation, trusted }: Share) {
  if (run) return <a href={`/runs/${run}`}>{text.archiveOf(generation)}</a>;
  return (
    <>
      <a href={`/creatures/${creature}`}>{text.creatureLink}</a>{" "}
      <TrustBadge trusted={trusted} href={`/creatures/${creature}#audit`} />
    </>
  );
}

function Actions({ share, onChange }: { share: Share; onChange: (share: Share) => void }) {
  const { title, url, state } = share;
  if (state !== "live") return null;
  return (
    <span class="actions">
      <button
        class="slim"
        aria-label={text.copyLinkOf(title)}
        onClick={() => void copyText(url, text.linkCopied)}
      >
        {text.copyLink}
      </button>
      <ConfirmButton verb={text.revoke} what={title} onConfirm={() => revoke(share, onChange)} />
    </span>
  );
}

async function revoke(share: Share, onChange: (share: Share) => void): Promise<void> {
  const revoked = await orShowError(api.revoke(share.slug));
  if (!revoked) return;
  onChange(revoked);
  showToast({ kind: "note", text: text.revoked(share.title) });
}
