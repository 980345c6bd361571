/** What can be kept of a run, and how it came to be. */

import { archiveUrl, proveFile, resultsUrl } from "../api/client";
import { messageOf } from "../api/problem";
import type { Run } from "../api/types";
import { hasArchive } from "../live/fetching";
import { tell } from "../live/toasts";
import { moment, short } from "../view/format";

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

/** A download that says why where there is no file yet. */
function FileLink({ url, name }: { url: string; name: string }) {
  const download = (event: MouseEvent) => {
    event.preventDefault();
    proveFile(url)
      .then(() => location.assign(url))
      .catch((error) => tell({ kind: "wrong", text: messageOf(error) }));
  };
  return (
    <a class="button" href={url} onClick={download}>
      {name}
    </a>
  );
}
