/** All requests of the page. Failed requests throw a `Problem`. */

import { SHARE_HEADER, sharedSlug } from "./address";
import { type Answer, ROOT, client, success, whenReady } from "./http";
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

/** Give an answer a narrower type than OpenAPI has. */
const typed = <T>(request: Promise<Answer<unknown>>) => success(request) as Promise<T>;

const at = <Path, Query>(path: Path, query: Query) => ({ params: { path, query } });
const run = <Query = undefined>(id: string, query?: Query) => at({ run_id: id }, query as Query);
const sweep = <Query = undefined>(id: string, query?: Query) => at({ sweep_id: id }, query as Query);
const creature = <Query = undefined>(sha: string, query?: Query) => at({ sha }, query as Query);
const keyed = (key: string) => ({ header: { "Idempotency-Key": key } });

export const readPrincipal = () => success(client.GET(`${ROOT}/tokens/current`));
export const readHealth = () => success(client.GET("/healthz"));
export const readTokens = () => success(client.GET(`${ROOT}/tokens`));
export const createToken = (body: TokenCreate) => success(client.POST(`${ROOT}/tokens`, { body }));
export const revokeToken = (id: string) =>
  success(client.DELETE(`${ROOT}/tokens/{token_id}`, { params: { path: { token_id: id } } }));

/** The browser stores the token where no script can read it. */
export const signIn = (token: string) => success(client.POST(`${ROOT}/session`, { body: { token } }));
export const signOut = () => success(client.DELETE(`${ROOT}/session`));

/** All experiments; none for visitors of a share, because they cannot start runs. */
export const readExperiments = async (): Promise<Experiment[]> =>
  sharedSlug ? [] : typed(client.GET(`${ROOT}/experiments`));
export const readTags = () => success(client.GET(`${ROOT}/tags`));
export const readWorkers = () => success(client.GET(`${ROOT}/workers`));
export const readQueue = () => success(client.GET(`${ROOT}/queue`));

export const readRuns = (query: RunQuery) =>
  typed<RunPage>(client.GET(`${ROOT}/runs`, { params: { query } }));
export const readRun = (id: string) => typed<Run>(client.GET(`${ROOT}/runs/{run_id}`, run(id)));
export const estimateRun = (spec: Spec) =>
  success(client.POST(`${ROOT}/runs/estimate`, { body: spec as never }));
export const createRun = (spec: Spec, key: string) =>
  typed<Run>(client.POST(`${ROOT}/runs`, { params: keyed(key), body: spec as never }));
export function forkRun({ run: id, ...body }: ForkRequest, key: string) {
  const params = { ...run(id).params, ...keyed(key) };
  return typed<Run>(client.POST(`${ROOT}/runs/{run_id}/fork`, { params, body: body as never }));
}
export const changeRun = (id: string, change: RunChange) =>
  typed<Run>(client.PATCH(`${ROOT}/runs/{run_id}`, { ...run(id), body: change as never }));
export const extendRun = (id: string, generations: number) =>
  typed<Run>(client.POST(`${ROOT}/runs/{run_id}/extend`, { ...run(id), body: { generations } }));
export const commandRun = (id: string, verb: RunCommand) =>
  typed<Run>(client.POST(`${ROOT}/runs/{run_id}/${verb}`, run(id)));
/** Move a run to the bin. */
export const deleteRun = (id: string) => typed<Run>(client.DELETE(`${ROOT}/runs/{run_id}`, run(id)));
export const restoreRun = (id: string) => typed<Run>(client.POST(`${ROOT}/runs/{run_id}/restore`, run(id)));

const joined = (measures: string[]) => (measures.length > 0 ? { measures: measures.join(",") } : {});

/** The archive, now or after a generation, with columns of named measures; `after` skips older elites. */
export const readArchive = (
  id: string,
  measures: string[] = [],
  when: { generation?: number; after?: number } = {},
) => success(client.GET(`${ROOT}/runs/{run_id}/archive`, run(id, { ...joined(measures), ...when })));
/** Every elite that ever entered the archive, with columns of named measures. */
export const readHistory = (id: string, measures: string[]) =>
  success(client.GET(`${ROOT}/runs/{run_id}/archive/history`, run(id, joined(measures))));
/** Centroids of the cells of a CVT archive; null before its first checkpoint. */
export const readCentroids = async (id: string): Promise<number[][] | null> =>
  (await success(client.GET(`${ROOT}/runs/{run_id}/archive/centroids`, run(id)))).centroids;
export const readResults = (id: string) =>
  typed<Results>(client.GET(`${ROOT}/runs/{run_id}/results`, run(id)));
export const readGenerations = (id: string, points: number) =>
  success(client.GET(`${ROOT}/runs/{run_id}/generations`, run(id, { points })));
/** The newest log entries, oldest first, or those that follow an entry. */
export const readLog = (id: string, limit: number, after?: number) =>
  success(client.GET(`${ROOT}/runs/{run_id}/log`, run(id, { limit, after })));
export const readSpecies = (id: string) => success(client.GET(`${ROOT}/runs/{run_id}/species`, run(id)));
export const readTargets = (id: string) => success(client.GET(`${ROOT}/runs/{run_id}/targets`, run(id)));

export const readSweeps = (limit: number) =>
  typed<SweepPage>(client.GET(`${ROOT}/sweeps`, { params: { query: { limit } } }));
export const readSweep = (id: string) => typed<Sweep>(client.GET(`${ROOT}/sweeps/{sweep_id}`, sweep(id)));
export const readSweepSummary = (id: string, points: number) =>
  typed<SweepSummary>(client.GET(`${ROOT}/sweeps/{sweep_id}/summary`, sweep(id, { points })));
export const readSweepCurves = (id: string, points: number) =>
  success(client.GET(`${ROOT}/sweeps/{sweep_id}/curves`, sweep(id, { points })));
export const estimateSweep = (request: SweepRequest) =>
  success(client.POST(`${ROOT}/sweeps/estimate`, { body: request as never }));
export const createSweep = (request: SweepRequest, key: string) =>
  typed<Sweep>(client.POST(`${ROOT}/sweeps`, { params: keyed(key), body: request as never }));
export const commandSweep = (id: string, verb: RunCommand) =>
  typed<SweepChanged>(client.POST(`${ROOT}/sweeps/{sweep_id}/${verb}`, sweep(id)));
export const renameSweep = (id: string, name: string | null) =>
  typed<Sweep>(client.PATCH(`${ROOT}/sweeps/{sweep_id}`, { ...sweep(id), body: { name } }));
/** Move the runs of a sweep to the bin, except active ones. */
export const deleteSweep = (id: string) =>
  typed<SweepChanged>(client.DELETE(`${ROOT}/sweeps/{sweep_id}`, sweep(id)));
export const restoreSweep = (id: string) =>
  typed<SweepChanged>(client.POST(`${ROOT}/sweeps/{sweep_id}/restore`, sweep(id)));

export const readCreature = (sha: string) =>
  typed<Creature>(client.GET(`${ROOT}/creatures/{sha}`, creature(sha)));

const CHILDLESS: Children = { total: 0, items: [] };

/** Ancestors of `depth` generations, and children; a share contains no children. */
export function readFamily(sha: string, depth: number): Promise<[Ancestors, Children]> {
  const up = success(client.GET(`${ROOT}/creatures/{sha}/ancestors`, creature(sha, { depth })));
  if (sharedSlug) return Promise.all([up, CHILDLESS]);
  return Promise.all([up, success(client.GET(`${ROOT}/creatures/{sha}/children`, creature(sha)))]);
}

/** Upload a creature file, JSON or HDF5, byte for byte. */
export function importCreature(file: Blob) {
  const body = { body: file as never, bodySerializer: () => file };
  const headers = { "Content-Type": file.type || "application/octet-stream" };
  return success(client.POST(`${ROOT}/creatures`, { ...body, headers }));
}

/** The replay; null while the renderer prepares it. */
export const readReplay = (sha: string) =>
  whenReady<ArrayBuffer>(
    client.GET(`${ROOT}/creatures/{sha}/replay`, { ...creature(sha), parseAs: "arrayBuffer" }),
  );
export const readMotion = (sha: string, headers = {}) =>
  whenReady<ArrayBuffer>(
    client.GET(`${ROOT}/creatures/{sha}/motion`, { ...creature(sha), headers, parseAs: "arrayBuffer" }),
  );
export const readCover = ({ slug, cover }: Share) => readMotion(cover, { [SHARE_HEADER]: slug });
export const readAudit = (sha: string) =>
  whenReady<Audit>(client.GET(`${ROOT}/creatures/{sha}/audit`, creature(sha)));

/** Evaluate a creature again with the program that measured it. */
export const startMeasurement = (sha: string) =>
  success(client.POST(`${ROOT}/creatures/{sha}/measure`, creature(sha)));

/** Null while the creature is measured, `never` without a measurement. */
export async function readMeasurement(sha: string): Promise<Measurement | "never" | null> {
  const request = client.GET(`${ROOT}/creatures/{sha}/measurement`, creature(sha));
  const { status } = (await request).response;
  if (status === 204) return "never";
  return whenReady<Measurement>(request);
}

const share = (slug: string) => ({ params: { path: { slug } } });
const page = (cursor?: string) => ({ params: { query: { cursor } } });

export const readShare = (slug: string): Promise<Share> =>
  success(client.GET(`${ROOT}/shares/{slug}`, share(slug)));
export const readShares = (cursor?: string) => success(client.GET(`${ROOT}/shares`, page(cursor)));
export const readCommons = (cursor?: string) => success(client.GET(`${ROOT}/commons`, page(cursor)));
export const publish = (body: ShareRequest): Promise<Share> =>
  success(client.POST(`${ROOT}/shares`, { body }));
export const revoke = (slug: string): Promise<Share> =>
  success(client.DELETE(`${ROOT}/shares/{slug}`, share(slug)));
