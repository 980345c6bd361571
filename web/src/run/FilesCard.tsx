/** What can be kept of a run, and how it came to be. */

import { archiveUrl, resultsUrl } from "../api/urls";
import type { Run } from "../api/types";
import { hasArchive } from "../store/fetch";
import { moment } from "../ui/format";
import { FileLink } from "../ui/FileLink";

export function FilesCard({ run }: { run: Run }) {
  return (
    <section class="card files" id="files" aria-labelledby="files-title" tabIndex={-1}>
      <h2 id="files-title">Files</h2>
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
        {hasArchive(run) ? "Archive files are" : "results.h5 is"} of the last checkpoint. Created{" "}
        {moment(run.created_at)}, attempt {run.attempt}, version {run.version}
        {run.device && `, on ${run.device}`}.
      </p>
    </section>
  );
}
