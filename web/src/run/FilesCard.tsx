/** Files of a run. */

import { sharedSlug } from "../api/address";
import { archiveUrl, choicesUrl, resultsUrl } from "../api/files";
import type { Run } from "../api/types";
import { useKnownChoices } from "../store/choices";
import { hasArchive } from "../store/fetch";
import { FileLink } from "../ui/links";
import { Card } from "../ui/Page";
import { text } from "./text";
import { useState } from "preact/hooks";
import { lazy } from "../ui/lazy";
import "./exports/exports.css";

export function FilesCard({ run, about }: { run: Run; about: string }) {
  const chosen = useKnownChoices(run.id)?.items.some(({ generation }) => generation !== null);
  const [name, csv] = hasArchive(run)
    ? ["archive", archiveUrl(run.id, "csv")]
    : ["results", resultsUrl(run.id)];
  return (
    <Card id="files" title={text.files}>
      <div class="links">
        <FileLink url={archiveUrl(run.id, "h5")} name={`${name}.h5`} />
        <FileLink url={csv} name={`${name}.csv`} />
        {chosen && <FileLink url={choicesUrl(run.id)} name="choices.json" title={text.choicesAbout} />}
        {!sharedSlug && <ExportMenu run={run} />}
      </div>
      <p class="quiet">{about}</p>
    </Card>
  );
}

const ExportFormats = lazy(async () => (await import("./exports/ExportFormats")).ExportFormats, "section");

/** The button below which the formats of exports open. */
function ExportMenu({ run }: { run: Run }) {
  const [opened, setOpened] = useState(false);
  return (
    <details class="exports" onToggle={() => setOpened(true)}>
      <summary class="button">{text.export}</summary>
      {opened && <ExportFormats run={run} />}
    </details>
  );
}
