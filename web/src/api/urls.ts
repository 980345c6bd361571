/** Addresses of files that the server offers for download. */

import { ROOT } from "./http";

export const archiveUrl = (id: string, kind: "h5" | "csv") => `${ROOT}/runs/${id}/archive.${kind}`;
export const resultsUrl = (id: string) => `${ROOT}/runs/${id}/results.csv`;
export type PictureFormat = "strip.png" | "film.gif" | "film.mp4";
export const pictureUrl = (sha: string, kind: PictureFormat) => `${ROOT}/creatures/${sha}/${kind}`;
export type NetworkFormat = "svg" | "dot" | "py" | "npz";
export const networkUrl = (sha: string, form: NetworkFormat) => `${ROOT}/creatures/${sha}/network.${form}`;
export const creatureFileUrl = (sha: string) => `${ROOT}/creatures/${sha}?download=1&ancestors=1`;
export const creatureH5Url = (sha: string) => `${ROOT}/creatures/${sha}/creature.h5`;
