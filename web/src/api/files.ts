/** Addresses of files; checking and downloading them. */

import { shareHeaders, sharedSlug } from "./address";
import { problemOf } from "./problem";
import type { ComparedRuns } from "./types";
import { noteStatus, ROOT } from "./http";

/** True if a rendering exists, null while it is rendered; its content is not read. */
export async function renderingReady(url: string): Promise<true | null> {
  return (await checkFile(url)).status === 202 ? null : true;
}

/** Throw if a file does not exist; its content is not read. */
export async function checkFile(url: string): Promise<Response> {
  const stop = new AbortController();
  const response = await request(url, stop.signal);
  stop.abort();
  return response;
}

async function request(url: string, signal?: AbortSignal): Promise<Response> {
  const response = await fetch(url, { signal, headers: shareHeaders });
  noteStatus(response.status);
  if (!response.ok) throw problemOf(response.status, await response.json().catch(() => null));
  return response;
}

/** Download a file under the server's name for it. In a share, fetch it: a link cannot send the header. */
export async function downloadFile(url: string): Promise<void> {
  if (!sharedSlug) return follow(url, "");
  const response = await request(url);
  const named = /filename="([^"]*)"/.exec(response.headers.get("Content-Disposition") ?? "");
  saveFile(await response.blob(), named?.[1] ?? "");
}

/** Let the browser save a file that the page has made. */
export function saveFile(file: Blob, name: string): void {
  const url = URL.createObjectURL(file);
  follow(url, name);
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

function follow(url: string, name: string): void {
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
}

export const archiveUrl = (id: string, kind: "h5" | "csv") => `${ROOT}/runs/${id}/archive.${kind}`;
export const resultsUrl = (id: string) => `${ROOT}/runs/${id}/results.csv`;
/** The chosen creatures: with the spec they repeat a run. */
export const choicesUrl = (id: string) => `${ROOT}/runs/${id}/choices.json`;
/** The statistics of runs, compared by `measures`. */
export const statisticsUrl = (kind: "csv" | "tex", of: ComparedRuns, measures: string) =>
  `${ROOT}/statistics.${kind}?${new URLSearchParams({ ...of, measures })}`;
export type PhylogenyFile = "csv" | "nwk";
/** `of` is the path of a run or a creature. */
export const phylogenyUrl = (of: string, kind: PhylogenyFile) => `${ROOT}${of}/phylogeny.${kind}`;
export type PictureFormat = "strip.png" | "film.gif" | "film.mp4";
export const pictureUrl = (sha: string, kind: PictureFormat) => `${ROOT}/creatures/${sha}/${kind}`;
export const posesUrl = (sha: string, kind: "csv" | "npz") => `${ROOT}/creatures/${sha}/poses.${kind}`;
export type NetworkFormat = "svg" | "dot" | "py" | "npz";
export const networkUrl = (sha: string, kind: NetworkFormat) => `${ROOT}/creatures/${sha}/network.${kind}`;
export const creatureFileUrl = (sha: string) => `${ROOT}/creatures/${sha}?download=1&ancestors=1`;
export const creatureH5Url = (sha: string) => `${ROOT}/creatures/${sha}/creature.h5`;

export type ExportFormat = "parquet" | "arrow" | "alife" | "newick" | "netcdf" | "ro-crate";

/** With a real length and period as typed, the file has columns in SI units. */
export const exportUrl = (
  id: string,
  format: ExportFormat,
  real: { length: string; period: string } | null,
) =>
  `${ROOT}/runs/${id}/export/${format}` +
  (real ? `?${new URLSearchParams({ length: real.length, period: real.period })}` : "");
