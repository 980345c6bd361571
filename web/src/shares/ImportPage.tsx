/** Import a shared creature of another installation, after its hash is verified in this browser. */

import { importCreature } from "../api/client";
import { type ForeignCreature, readForeignCreature } from "../api/foreign";
import { foreignFileUrl, foreignNamesUrl } from "../api/shareAddress";
import { useFetched } from "../store/fetch";
import { useRefusal } from "../store/principal";
import { navigate } from "../store/router";
import { useSubmit } from "../ui/forms";
import { number, shortId } from "../ui/format";
import { Card, Loading, Page } from "../ui/Page";
import { Fact } from "./Fact";
import { ImportAll } from "./ImportAll";
import { text } from "./text";
import "./shares.css";

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
      <dl class="facts terms">
        <Fact name={text.from}>{host}</Fact>
        {credit.length > 0 && <Fact name={text.credit}>{credit.join(", ")}</Fact>}
        <Fact name={text.licence}>{licence}</Fact>
        {measured && <Fact name={text.fitness}>{number(measured.fitness, 4)}</Fact>}
        <Fact name={text.ancestors}>{ancestors.length}</Fact>
        <Fact name="SHA-256">
          <code>{sha256}</code>
        </Fact>
      </dl>
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
