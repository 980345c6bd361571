/** The formats in which a run can be downloaded, below their button. */

import { useState } from "preact/hooks";
import { checkFile, downloadFile, exportUrl, type ExportFormat } from "../../api/files";
import type { Run } from "../../api/types";
import { hasArchive } from "../../store/fetch";
import { showFailure } from "../../store/toasts";
import "./exports.css";
import { text } from "./text";

const TABLES: readonly ExportFormat[] = ["parquet", "arrow"];
const FORMATS = Object.keys(text.formats) as ExportFormat[];

/** A server takes seconds for a large run: the format says so until its file comes. */
export function ExportMenu({ run }: { run: Run }) {
  const [preparing, setPreparing] = useState<ExportFormat | null>(null);
  const download = async (format: ExportFormat) => {
    if (preparing) return;
    setPreparing(format);
    try {
      const url = exportUrl(run.id, format);
      await checkFile(url);
      await downloadFile(url);
    } catch (error) {
      showFailure(error);
    } finally {
      setPreparing(null);
    }
  };
  return (
    <details class="exports">
      <summary class="button">{text.export}</summary>
      <p class="quiet small">{text.about}</p>
      <ul>
        {(hasArchive(run) ? FORMATS : TABLES).map((format) => (
          <li key={format}>
            <button class="link" aria-disabled={preparing !== null} onClick={() => void download(format)}>
              {text.formats[format][0]}
            </button>
            <span class="quiet small" role={preparing === format ? "status" : undefined}>
              {preparing === format ? text.preparing : text.formats[format][1]}
            </span>
          </li>
        ))}
      </ul>
    </details>
  );
}
