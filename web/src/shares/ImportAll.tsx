/** Import all creatures of a shared archive, each of them verified by its hash in this browser. */

import { useState } from "preact/hooks";
import { importCreature } from "../api/client";
import { foreignFileOf, readForeignCreature, readForeignNames } from "../api/foreign";
import { useFetched } from "../store/fetch";
import { useRefusal } from "../store/principal";
import { useLeaving, useSubmit } from "../ui/forms";
import { shortId } from "../ui/format";
import { Card, Progress } from "../ui/Page";
import { text } from "./text";

/** `url`: the address of the names. Nothing is shown for a share of one creature. */
export function ImportAll({ url }: { url: string }) {
  const refusal = useRefusal();
  const { value: names } = useFetched(() => readForeignNames(url), [url]);
  const [done, setDone] = useState(0);
  const leaving = useLeaving();
  const { busy, error, onSubmit } = useSubmit(async () => {
    // What was imported before an error stays.
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
