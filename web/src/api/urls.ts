/** Addresses of files that the server offers for download. */

import { API_BASE } from "./address";

export const archiveUrl = (id: string, kind: "h5" | "csv") => `${API_BASE}/runs/${id}/archive.${kind}`;
export const resultsUrl = (id: string) => `${API_BASE}/runs/${id}/results.csv`;
export type PictureFormat = "strip.png" | "film.gif" | "film.mp4";
export const pictureUrl = (sha: string, kind: PictureFormat) => `${API_BASE}/creatures/${sha}/${kind}`;
export type NetworkFormat = "svg" | "dot" | "py" | "npz";
export const networkUrl = (sha: string, form: NetworkFormat) =>
  `${API_BASE}/creatures/${sha}/network.${form}`;
export const creatureFileUrl = (sha: string) => `${API_BASE}/creatures/${sha}?download=1&ancestors=1`;
export const creatureH5Url = (sha: string) => `${API_BASE}/creatures/${sha}/creature.h5`;
