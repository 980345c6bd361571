/** Import a shared creature of another installation, or all of an archive, after their hashes are verified here. */

import { importCreature } from "../api/client";
import { type ForeignCreature, readForeignCreature, foreignFileOf, readForeignNames } from "../api/foreign";
import { foreignFileUrl, foreignNamesUrl } from "../api/address";
import { useFetched } from "../store/fetch";
import { useRefusal } from "../store/principal";
import { navigate } from "../store/router";
import { Facts } from "../ui/Facts";
import { useSubmit, useLeaving } from "../ui/forms";
import { number, shortId } from "../ui/format";
import { Card, Loading, Page, Progress } from "../ui/Page";
import { text } from "./text";
import "./shares.css";
import { useState } from "preact/hooks";

export function ImportPage({ query }: { query: URLSearchParams }) {
  const address = query.get("share") ?? "";
  const url = foreignFileUrl(address);
  const names = foreignNamesUrl(address);
  return (
    <Page title={text.importTitle}>
      <section class="card">
        <ImportForm address={address} />
      </section>
      {address && !url && <p class="banner wrong">{text.noAddress}</p>}
      {url && <Incoming key={url} url={url} />}
      {names && <ImportAll key={names} url={names} />}
    </Page>
  );
}

/** The address is submitted by a new request of the page, whose policy then permits the files of that share alone. */
export function ImportForm({ address }: { address: string }) {
  return (
    <form class="import-form" action="/import">
      <label class="over">
        {text.shareAddress}
        <input name="share" type="url" required defaultValue={address} placeholder="https://…/s/…" />
      </label>
      <button class={address ? "" : "primary"}>{text.look}</button>
    </form>
  );
}

function Incoming({ url }: { url: string }) {
  const { host } = new URL(url);
  const { value, error } = useFetched(
    () => readForeignCreature(url).catch((reason) => explain(reason, host)),
    [url],
  );
  if (error) return <p class="banner wrong">{error}</p>;
  if (!value) return <Loading />;
  return <Verified {...value} host={host} />;
}

function explain(reason: unknown, host: string): never {
  const silent = reason instanceof TypeError || (reason as Error).name === "TimeoutError";
  throw silent ? new Error(text.unreachable(host)) : reason;
}

function Verified({ creature, ancestors, file, host }: ForeignCreature & { host: string }) {
  const refusal = useRefusal();
  const { sha256, credit = [], licence, measured } = creature;
  const { busy, error, onSubmit } = useSubmit(async () => {
    await importCreature(file);
    navigate(`/creatures/${sha256}`);
  });
  return (
    <Card
      id="incoming"
      title={[text.creature, " ", <code>{shortId(sha256)}</code>]}
      note={<span class="badge finished">{text.hashVerified}</span>}
    >
      <Facts
        kind="facts terms"
        of={[
          [text.from, host],
          credit.length > 0 && [text.credit, credit.join(", ")],
          [text.licence, licence],
          measured && [text.fitness, number(measured.fitness, 4)],
          [text.ancestors, ancestors.length],
          ["SHA-256", <code>{sha256}</code>],
        ]}
      />
      <form onSubmit={onSubmit}>
        <button class="primary" disabled={busy || refusal !== null}>
          {busy ? text.importing : text.import}
        </button>{" "}
        <span class="quiet small">{refusal ?? text.importAbout}</span>
      </form>
      {error && <p class="banner wrong">{error}</p>}
    </Card>
  );
}

/** `url`: the address of the names. Nothing is shown for a share of one creature. */
function ImportAll({ url }: { url: string }) {
  const refusal = useRefusal();
  const { value: names } = useFetched(() => readForeignNames(url), [url]);
  const [done, setDone] = useState(0);
  const leaving = useLeaving();
  const { busy, error, onSubmit } = useSubmit(async () => {
    // Creatures that were imported before an error stay.
    for (let k = done; k < names!.length && !leaving.aborted; k++) {
      const { file } = await readForeignCreature(foreignFileOf(url, names![k]!));
      await importCreature(file);
      setDone(k + 1);
    }
  });
  if (!names || names.length < 2) return null;
  const complete = done === names.length;
  return (
    <Card id="incoming-all" title={text.importAllTitle(names.length)}>
      {done > 0 && <Progress label={text.importProgress} share={done / names.length} kind="running" />}
      <p class="small" role="status">
        {complete ? text.importedAll(names.length) : done > 0 && text.importedSome(done, names.length)}
      </p>
      {complete && <Links names={names} />}
      {!complete && (
        <form onSubmit={onSubmit}>
          <button disabled={busy || refusal !== null}>{busy ? text.importing : text.importAll}</button>{" "}
          <span class="quiet small">{refusal ?? text.importAllAbout}</span>
        </form>
      )}
      {error && <p class="banner wrong">{error}</p>}
    </Card>
  );
}

/** The best ones: nobody reads hundreds. */
const SHOWN = 12;

const Links = ({ names }: { names: string[] }) => (
  <p class="small">
    {names.slice(0, SHOWN).map((name) => (
      <span key={name}>
        <a href={`/creatures/${name}`}>
          <code>{shortId(name)}</code>
        </a>{" "}
      </span>
    ))}
  </p>
);
