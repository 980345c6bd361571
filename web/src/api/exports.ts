/** Addresses of exports: runs in the formats of other programs. */

import { ROOT } from "./http";

export type ExportFormat = "parquet" | "arrow" | "alife" | "newick" | "netcdf" | "ro-crate";

/** With a real length and period as typed, the file has columns in SI units. */
export const exportUrl = (
  id: string,
  format: ExportFormat,
  real: { length: string; period: string } | null,
) =>
  `${ROOT}/runs/${id}/export/${format}` +
  (real ? `?${new URLSearchParams({ length: real.length, period: real.period })}` : "");
