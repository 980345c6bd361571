/** Files of a run. */

import { archiveUrl, resultsUrl } from "../api/urls";
import type { Run } from "../api/types";
import { hasArchive } from "../store/fetch";
import { moment } from "../ui/format";
import { FileLink } from "../ui/FileLink";
import { text } from "./text";

export function FilesCard({ run }: { run: Run }) {
  return (
    <section class="card files" id="files" aria-labelledby="files-title" tabIndex={-1}>
      <h2 id="files-title">{text.files}</h2>
      <p class="links">
        {hasArchive(run) ? (
          <>
            <FileLink url={archiveUrl(run.id, "h5")} name="archive.h5" />
            <FileLink url={archiveUrl(run.id, "csv")} name="archive.csv" />
          </>
        ) : (
          <>
            <FileLink url={archiveUrl(run.id, "h5")} name="results.h5" />
            <FileLink url={resultsUrl(run.id)} name="results.csv" />
          </>
        )}
      </p>
      <p class="quiet">
        {text.filesAbout(hasArchive(run), moment(run.created_at), run.attempt, run.version, run.device)}
      </p>
    </section>
  );
}
