/** Every request of the page. Answers other than success are thrown as `Problem`. */

import { SHARE_HEADER, sharedSlug } from "./address";
import { ROOT, client, success, whenReady } from "./http";
import type {
  Ancestors,
  Audit,
  Children,
  Creature,
  Experiment,
  ForkRequest,
  Measurement,
  Results,
  Run,
  RunChange,
  RunPage,
  RunQuery,
  Share,
  ShareRequest,
  Spec,
  Sweep,
  SweepChanged,
  SweepPage,
  SweepRequest,
  SweepSummary,
  TokenCreate,
} from "./types";

export const EVENTS_URL = `${ROOT}/events`;

export type RunCommand = "pause" | "resume" | "cancel";

const run = (id: string) => ({ params: { path: { run_id: id } } });

/** Strangers start none. */
export async function readExperiments(): Promise<Experiment[]> {
  if (sharedSlug) return [];
  return (await success(client.GET(`${ROOT}/experiments`))) as Experiment[];
}

export async function readRuns(query: RunQuery): Promise<RunPage> {
  return (await success(client.GET(`${ROOT}/runs`, { params: { query } }))) as RunPage;
}

export async function changeRun(id: string, change: RunChange): Promise<Run> {
  const asked = client.PATCH(`${ROOT}/runs/{run_id}`, { ...run(id), body: change as never });
  return (await success(asked)) as Run;
}

export const readPrincipal = () => success(client.GET(`${ROOT}/tokens/current`));
export const readHealth = () => success(client.GET("/healthz"));
export const readTokens = () => success(client.GET(`${ROOT}/tokens`));
export const createToken = (body: TokenCreate) => success(client.POST(`${ROOT}/tokens`, { body }));

export function revokeToken(id: string) {
  const params = { path: { token_id: id } };
  return success(client.DELETE(`${ROOT}/tokens/{token_id}`, { params }));
}

/** Whether the token is right; the browser keeps it where no script can read it. */
export const signIn = (token: string) => success(client.POST(`${ROOT}/session`, { body: { token } }));
export const signOut = () => success(client.DELETE(`${ROOT}/session`));
export async function extendRun(id: string, generations: number): Promise<Run> {
  const asked = client.POST(`${ROOT}/runs/{run_id}/extend`, { ...run(id), body: { generations } });
  return (await success(asked)) as Run;
}

/** Into the bin. */
export async function deleteRun(id: string): Promise<Run> {
  return (await success(client.DELETE(`${ROOT}/runs/{run_id}`, run(id)))) as Run;
}

/** Out of the bin. */
export async function restoreRun(id: string): Promise<Run> {
  return (await success(client.POST(`${ROOT}/runs/{run_id}/restore`, run(id)))) as Run;
}

export const readTags = () => success(client.GET(`${ROOT}/tags`));
export const readWorkers = () => success(client.GET(`${ROOT}/workers`));
export const readQueue = () => success(client.GET(`${ROOT}/queue`));

export async function readRun(id: string): Promise<Run> {
  return (await success(client.GET(`${ROOT}/runs/{run_id}`, run(id)))) as Run;
}

/**
 * The archive now or as of a generation, with columns of the measures that are named; only what
 * entered later than `after`, where that is given.
 */
export function readArchive(
  id: string,
  measures: string[] = [],
  { generation, after }: { generation?: number; after?: number } = {},
) {
  const query = { ...(measures.length > 0 && { measures: measures.join(",") }), generation, after };
  const params = { path: { run_id: id }, query };
  return success(client.GET(`${ROOT}/runs/{run_id}/archive`, { params }));
}

/** Every elite that ever entered, with columns of the measures that are named. */
export function readHistory(id: string, measures: string[]) {
  const query = measures.length > 0 ? { measures: measures.join(",") } : {};
  const params = { path: { run_id: id }, query };
  return success(client.GET(`${ROOT}/runs/{run_id}/archive/history`, { params }));
}

/** Where the cells of a CVT archive are; null before its first checkpoint. */
export async function readCentroids(id: string): Promise<number[][] | null> {
  return (await success(client.GET(`${ROOT}/runs/{run_id}/archive/centroids`, run(id)))).centroids;
}

export async function readResults(id: string): Promise<Results> {
  return (await success(client.GET(`${ROOT}/runs/{run_id}/results`, run(id)))) as Results;
}

export function readGenerations(id: string, points: number) {
  const params = { path: { run_id: id }, query: { points } };
  return success(client.GET(`${ROOT}/runs/{run_id}/generations`, { params }));
}

/** The newest entries, the oldest of them first; those that follow one, where it is named. */
export function readLog(id: string, limit: number, after?: number) {
  const params = { path: { run_id: id }, query: { limit, after } };
  return success(client.GET(`${ROOT}/runs/{run_id}/log`, { params }));
}

export function readSpecies(id: string) {
  return success(client.GET(`${ROOT}/runs/{run_id}/species`, run(id)));
}

export function readTargets(id: string) {
  return success(client.GET(`${ROOT}/runs/{run_id}/targets`, run(id)));
}

export function estimateRun(spec: Spec) {
  return success(client.POST(`${ROOT}/runs/estimate`, { body: spec as never }));
}

export async function createRun(spec: Spec, key: string): Promise<Run> {
  const params = { header: { "Idempotency-Key": key } };
  return (await success(client.POST(`${ROOT}/runs`, { params, body: spec as never }))) as Run;
}

export async function forkRun({ run: id, ...body }: ForkRequest, key: string): Promise<Run> {
  const params = { ...run(id).params, header: { "Idempotency-Key": key } };
  const asked = client.POST(`${ROOT}/runs/{run_id}/fork`, { params, body: body as never });
  return (await success(asked)) as Run;
}

export async function commandRun(id: string, verb: RunCommand): Promise<Run> {
  return (await success(client.POST(`${ROOT}/runs/{run_id}/${verb}`, run(id)))) as Run;
}

const sweep = (id: string) => ({ params: { path: { sweep_id: id } } });

export async function readSweeps(limit: number): Promise<SweepPage> {
  const asked = client.GET(`${ROOT}/sweeps`, { params: { query: { limit } } });
  return (await success(asked)) as SweepPage;
}

export async function readSweep(id: string): Promise<Sweep> {
  return (await success(client.GET(`${ROOT}/sweeps/{sweep_id}`, sweep(id)))) as Sweep;
}

/** What the runs of each case say together, at about so many generations. */
export async function readSweepSummary(id: string, points: number): Promise<SweepSummary> {
  const params = { path: { sweep_id: id }, query: { points } };
  return (await success(client.GET(`${ROOT}/sweeps/{sweep_id}/summary`, { params }))) as SweepSummary;
}

/** The curves of each run by itself. */
export function readSweepCurves(id: string, points: number) {
  const params = { path: { sweep_id: id }, query: { points } };
  return success(client.GET(`${ROOT}/sweeps/{sweep_id}/curves`, { params }));
}

export function estimateSweep(sent: SweepRequest) {
  return success(client.POST(`${ROOT}/sweeps/estimate`, { body: sent as never }));
}

export async function createSweep(sent: SweepRequest, key: string): Promise<Sweep> {
  const params = { header: { "Idempotency-Key": key } };
  return (await success(client.POST(`${ROOT}/sweeps`, { params, body: sent as never }))) as Sweep;
}

export async function commandSweep(id: string, verb: RunCommand): Promise<SweepChanged> {
  const asked = client.POST(`${ROOT}/sweeps/{sweep_id}/${verb}`, sweep(id));
  return (await success(asked)) as SweepChanged;
}

export async function renameSweep(id: string, name: string | null): Promise<Sweep> {
  const asked = client.PATCH(`${ROOT}/sweeps/{sweep_id}`, { ...sweep(id), body: { name } });
  return (await success(asked)) as Sweep;
}

/** Its runs into the bin, those that wait or are at work left out. */
export async function deleteSweep(id: string): Promise<SweepChanged> {
  return (await success(client.DELETE(`${ROOT}/sweeps/{sweep_id}`, sweep(id)))) as SweepChanged;
}

/** Its runs out of the bin. */
export async function restoreSweep(id: string): Promise<SweepChanged> {
  return (await success(client.POST(`${ROOT}/sweeps/{sweep_id}/restore`, sweep(id)))) as SweepChanged;
}

export async function readCreature(sha: string): Promise<Creature> {
  const asked = client.GET(`${ROOT}/creatures/{sha}`, { params: { path: { sha } } });
  return (await success(asked)) as unknown as Creature;
}

const CHILDLESS: Children = { total: 0, items: [] };

/** Parents and theirs over some generations, and what came of a creature: that is not shared. */
export function readFamily(sha: string, depth: number): Promise<[Ancestors, Children]> {
  const path = { path: { sha } };
  const up = client.GET(`${ROOT}/creatures/{sha}/ancestors`, { params: { ...path, query: { depth } } });
  if (sharedSlug) return Promise.all([success(up), CHILDLESS]);
  const down = client.GET(`${ROOT}/creatures/{sha}/children`, { params: path });
  return Promise.all([success(up), success(down)]);
}

/** Sends a creature file as it is, JSON or HDF5, byte for byte; answers its name. */
export function importCreature(file: Blob) {
  const body = { body: file as never, bodySerializer: () => file };
  const headers = { "Content-Type": file.type || "application/octet-stream" };
  return success(client.POST(`${ROOT}/creatures`, { ...body, headers }));
}

/** The replay's bytes, or null while the renderer is still at work on it. */
export function readReplay(sha: string): Promise<ArrayBuffer | null> {
  const params = { path: { sha } };
  return whenReady(client.GET(`${ROOT}/creatures/{sha}/replay`, { params, parseAs: "arrayBuffer" }));
}

/** The motion's bytes, or null while the renderer is still at work on the replay. */
export function readMotion(sha: string): Promise<ArrayBuffer | null> {
  const params = { path: { sha } };
  return whenReady(client.GET(`${ROOT}/creatures/{sha}/motion`, { params, parseAs: "arrayBuffer" }));
}

/** The audit, or null while the renderer is still at work on it. */
export function readAudit(sha: string): Promise<Audit | null> {
  return whenReady(client.GET(`${ROOT}/creatures/{sha}/audit`, { params: { path: { sha } } }));
}

/** A share, as whoever has its address sees it. */
export function readShare(slug: string): Promise<Share> {
  return success(client.GET(`${ROOT}/shares/{slug}`, { params: { path: { slug } } }));
}

export function readShares(cursor?: string) {
  return success(client.GET(`${ROOT}/shares`, { params: { query: { cursor } } }));
}

export function readCommons(cursor?: string) {
  return success(client.GET(`${ROOT}/commons`, { params: { query: { cursor } } }));
}

export function publish(asked: ShareRequest): Promise<Share> {
  return success(client.POST(`${ROOT}/shares`, { body: asked }));
}

export function revoke(slug: string): Promise<Share> {
  return success(client.DELETE(`${ROOT}/shares/{slug}`, { params: { path: { slug } } }));
}

/** The motion of the creature whose picture stands for a share; null while it is made. */
export function readCover({ slug, cover }: Share): Promise<ArrayBuffer | null> {
  const params = { path: { sha: cover } };
  const headers = { [SHARE_HEADER]: slug };
  return whenReady(client.GET(`${ROOT}/creatures/{sha}/motion`, { params, headers, parseAs: "arrayBuffer" }));
}

/** Has a creature evaluated again by the program that measured it. */
export function startMeasurement(sha: string) {
  return success(client.POST(`${ROOT}/creatures/{sha}/measure`, { params: { path: { sha } } }));
}

/** What came of it: null while it is measured, `never` where nobody has asked for it. */
export async function readMeasurement(sha: string): Promise<Measurement | "never" | null> {
  const asked = client.GET(`${ROOT}/creatures/{sha}/measurement`, { params: { path: { sha } } });
  const { status } = (await asked).response;
  if (status === 204) return "never";
  const found = (await success(asked)) as Measurement;
  return status === 202 ? null : found;
}
