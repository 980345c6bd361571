/** What can be kept of a run, and how it came to be. */

import { archiveUrl, resultsUrl } from "../api/client";
import type { Run } from "../api/types";
import { hasArchive } from "../live/fetching";
import { moment, short } from "../view/format";
import { FileLink } from "./FileLink";

export function Files({ run }: { run: Run }) {
  const spec = JSON.stringify(run.spec, null, 2);
  const href = `data:application/json;charset=utf-8,${encodeURIComponent(spec)}`;
  return (
    <section class="card files" aria-labelledby="files-title">
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
        <a class="button" href={href} download={`${short(run.id)}-spec.json`}>
          spec.json
        </a>
      </p>
      <p class="quiet">
        {hasArchive(run) ? "Archive files are" : "results.h5 is"} of the last checkpoint.{" "}
        Created {moment(run.created_at)}, attempt {run.attempt}, version {run.version}
        {run.device && `, on ${run.device}`}.
      </p>
      <details>
        <summary>Spec</summary>
        <pre>{spec}</pre>
      </details>
    </section>
  );
}
