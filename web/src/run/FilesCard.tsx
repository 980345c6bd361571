/** Files of a run. */

import { archiveUrl, resultsUrl } from "../api/files";
import type { Run } from "../api/types";
import { hasArchive } from "../store/fetch";
import { FileLink } from "../ui/links";
import { Card } from "../ui/Page";
import { text } from "./text";

export function FilesCard({ run, about }: { run: Run; about: string }) {
  const [name, csv] = hasArchive(run)
    ? ["archive", archiveUrl(run.id, "csv")]
    : ["results", resultsUrl(run.id)];
  return (
    <Card id="files" title={text.files}>
      <p class="links">
        <FileLink url={archiveUrl(run.id, "h5")} name={`${name}.h5`} />
        <FileLink url={csv} name={`${name}.csv`} />
      </p>
      <p class="quiet">{about}</p>
    </Card>
  );
}
