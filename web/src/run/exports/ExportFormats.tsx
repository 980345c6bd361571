/** The formats in which a run can be downloaded, with columns in SI units if asked for. */

import { useState } from "preact/hooks";
import { exportUrl, type ExportFormat } from "../../api/exports";
import { checkFile, downloadFile } from "../../api/files";
import type { Run } from "../../api/types";
import { hasArchive } from "../../store/fetch";
import { showFailure } from "../../store/toasts";
import { RealFields, useTyped } from "../../creature/real/RealFields";
import { problemOf, realOf } from "../../creature/real/quantity";
import { text } from "./text";

const TABLES: readonly ExportFormat[] = ["parquet", "arrow"];
/** Formats with columns in SI units. */
const WITH_SI: readonly ExportFormat[] = [...TABLES, "netcdf"];
const FORMATS = Object.keys(text.formats) as ExportFormat[];

/** A server takes seconds for a large run: the format says so until its file comes. */
export function ExportFormats({ run }: { run: Run }) {
  const [preparing, setPreparing] = useState<ExportFormat | null>(null);
  const [typed, change] = useTyped();
  const archive = hasArchive(run);
  const waits = (format: ExportFormat) =>
    preparing !== null || (archive && WITH_SI.includes(format) && problemOf(typed) !== null);
  const download = async (format: ExportFormat) => {
    if (waits(format)) return;
    setPreparing(format);
    try {
      const scaled = archive && WITH_SI.includes(format) && realOf(typed) !== null;
      const url = exportUrl(run.id, format, scaled ? typed : null);
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
          <RealFields typed={typed} onChange={change} />
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
