/** Addresses of files that the server offers for download. */

import { BASE } from "./address";

export const archiveUrl = (id: string, kind: "h5" | "csv") => `${BASE}/runs/${id}/archive.${kind}`;
export const resultsUrl = (id: string) => `${BASE}/runs/${id}/results.csv`;
export type Picture = "strip.png" | "film.gif" | "film.mp4";
export const pictureUrl = (sha: string, kind: Picture) => `${BASE}/creatures/${sha}/${kind}`;
export type Form = "svg" | "dot" | "py" | "npz";
export const networkUrl = (sha: string, form: Form) => `${BASE}/creatures/${sha}/network.${form}`;
export const creatureFileUrl = (sha: string) => `${BASE}/creatures/${sha}?download=1&ancestors=1`;
export const creatureH5Url = (sha: string) => `${BASE}/creatures/${sha}/creature.h5`;
