/** Every request of the page. Answers other than success are thrown as `Problem`. */

import { problemOf } from "./problem";
import type {
  Archive,
  Creature,
  Estimate,
  Experiment,
  Generations,
  Run,
  RunPage,
  Spec,
} from "./types";

const ROOT = "/api/v1";
export const EVENTS_URL = `${ROOT}/events`;

export type Wish = "pause" | "resume" | "cancel";

async function request(path: string, init?: RequestInit): Promise<Response> {
  const response = await fetch(ROOT + path, init);
  if (response.ok) return response;
  throw problemOf(response.status, await response.json().catch(() => null));
}

async function read<T>(path: string): Promise<T> {
  return (await request(path)).json();
}

async function post<T>(path: string, body?: unknown, headers: HeadersInit = {}): Promise<T> {
  const text = typeof body === "string" ? body : JSON.stringify(body);
  const response = await request(path, {
    method: "POST",
    ...(body === undefined
      ? { headers }
      : { body: text, headers: { "Content-Type": "application/json", ...headers } }),
  });
  return response.json();
}

export const readExperiments = () => read<Experiment[]>("/experiments");
export const readRun = (id: string) => read<Run>(`/runs/${id}`);
export const readArchive = (id: string) => read<Archive>(`/runs/${id}/archive`);
export const readCreature = (sha: string) => read<Creature>(`/creatures/${sha}`);
export const readGenerations = (id: string, points: number) =>
  read<Generations>(`/runs/${id}/generations?points=${points}`);

export function readRuns(cursor: string | null, limit: number): Promise<RunPage> {
  const query = new URLSearchParams({ limit: String(limit), ...(cursor ? { cursor } : {}) });
  return read<RunPage>(`/runs?${query}`);
}

export const estimateRun = (spec: Spec) => post<Estimate>("/runs/estimate", spec);
export const createRun = (spec: Spec, key: string) =>
  post<Run>("/runs", spec, { "Idempotency-Key": key });
export const wish = (id: string, verb: Wish) => post<Run>(`/runs/${id}/${verb}`);

/** Sends a creature file as it is, byte for byte; answers its name. */
export const importCreature = (text: string) => post<{ creature: string }>("/creatures", text);

/** The replay's bytes, or null while the renderer is still at work on it. */
export async function readReplay(sha: string): Promise<ArrayBuffer | null> {
  const response = await request(`/creatures/${sha}/replay`);
  return response.status === 202 ? null : response.arrayBuffer();
}

export const archiveUrl = (id: string, kind: "h5" | "csv") => `${ROOT}/runs/${id}/archive.${kind}`;
export const creatureFileUrl = (sha: string) => `${ROOT}/creatures/${sha}?download=1`;
