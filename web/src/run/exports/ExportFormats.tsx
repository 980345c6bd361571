/** The formats in which a run can be downloaded, with columns in SI units if asked for. */

import { useState } from "preact/hooks";
import { exportUrl, type ExportFormat } from "../../api/files";
import { checkFile, downloadFile } from "../../api/files";
import type { Run } from "../../api/types";
import { hasArchive } from "../../store/fetch";
import { showFailure } from "../../store/toasts";
import { RealFields, useReal } from "../../creature/RealFields";
import { text } from "./text";

const TABLES: readonly ExportFormat[] = ["parquet", "arrow"];
/** Formats with columns in SI units. */
const WITH_SI: readonly ExportFormat[] = [...TABLES, "netcdf"];
const FORMATS = Object.keys(text.formats) as ExportFormat[];

/** A server takes seconds for a large run: the format says so until its file comes. */
export function ExportFormats({ run }: { run: Run }) {
  const [preparing, setPreparing] = useState<ExportFormat | null>(null);
  const real = useReal(null);
  const archive = hasArchive(run);
  const waits = (format: ExportFormat) =>
    preparing !== null || (archive && WITH_SI.includes(format) && real.problem !== null);
  const download = async (format: ExportFormat) => {
    if (waits(format)) return;
    setPreparing(format);
    try {
      const scaled = archive && WITH_SI.includes(format) && real.typed.length !== "";
      const url = exportUrl(run.id, format, scaled ? real.typed : null);
      await checkFile(url);
      await downloadFile(url);
    } catch (error) {
      showFailure(error);
    } finally {
      setPreparing(null);
    }
  };
  return (
    <>
      <p class="quiet small">{text.about}</p>
      {archive && (
        <fieldset class="real-units">
          <legend class="small">{text.real}</legend>
          <RealFields {...real} />
        </fieldset>
      )}
      <ul>
        {(archive ? FORMATS : TABLES).map((format) => (
          <li key={format}>
            <button class="link" aria-disabled={waits(format)} onClick={() => void download(format)}>
              {text.formats[format][0]}
            </button>
            <span class="quiet small" role={preparing === format ? "status" : undefined}>
              {preparing === format ? text.preparing : text.formats[format][1]}
            </span>
          </li>
        ))}
      </ul>
    </>
  );
}
