/** All requests of the page. Failed requests throw a `Problem`. */

import { COLUMNS, decodeColumns } from "../decode/columns";
import { SHARE_HEADER, sharedSlug } from "./address";
import { type Answer, ROOT, client, success, whenReady } from "./http";
import type * as wire from "./types";

export const EVENTS_URL = `${ROOT}/events`;

export type RunCommand = "pause" | "resume" | "cancel" | "uncancel";
type SweepCommand = Exclude<RunCommand, "uncancel">;

/** Give an answer a narrower type than OpenAPI has. */
const typed = <T>(request: Promise<Answer<unknown>>) => success(request) as Promise<T>;

const at = <Path, Query>(path: Path, query: Query) => ({ params: { path, query } });
const run = <Query = undefined>(id: string, query?: Query) => at({ run_id: id }, query as Query);
const sweep = <Query = undefined>(id: string, query?: Query) => at({ sweep_id: id }, query as Query);
const creature = <Query = undefined>(sha: string, query?: Query) => at({ sha }, query as Query);
const keyed = (key: string) => ({ header: { "Idempotency-Key": key } });

export const readPrincipal = () => success(client.GET("/tokens/current"));
export const readHealth = () => success(client.GET("/healthz", { baseUrl: location.origin }));
export const readTokens = () => success(client.GET("/tokens"));
export const createToken = (body: wire.TokenCreate) => success(client.POST("/tokens", { body }));
export const revokeToken = (id: string) =>
  success(client.DELETE("/tokens/{token_id}", { params: { path: { token_id: id } } }));

/** The browser stores the token where no script can read it. */
export const signIn = (token: string) => success(client.POST("/session", { body: { token } }));
export const signOut = () => success(client.DELETE("/session"));

/** All experiments; none for visitors of a share, because they cannot start runs. */
export const readExperiments = async (): Promise<wire.Experiment[]> =>
  sharedSlug ? [] : typed(client.GET("/experiments"));
export const readTags = () => success(client.GET("/tags"));
export const readWorkers = () => success(client.GET("/workers"));
export const readQueue = () => success(client.GET("/queue"));

export const readRuns = (query: wire.RunQuery) =>
  typed<wire.RunPage>(client.GET("/runs", { params: { query } }));
export const readRun = (id: string) => typed<wire.Run>(client.GET("/runs/{run_id}", run(id)));
export const estimateRun = (spec: wire.Spec) =>
  success(client.POST("/runs/estimate", { body: spec as never }));
/** The inputs of the evaluation of a creature that a run would begin with; null while they are prepared. */
export const readFirstCreature = (spec: wire.Spec, number: number) =>
  whenReady<ArrayBuffer>(
    client.POST("/first-creature", {
      params: { query: { number } },
      body: spec as never,
      parseAs: "arrayBuffer",
    }),
  );
/** Queue a run, with a name if there is one. */
export function createRun(spec: wire.Spec, key: string, name: string | null) {
  const params = { ...keyed(key), query: name ? { name } : {} };
  return typed<wire.Run>(client.POST("/runs", { params, body: spec as never }));
}
export function forkRun({ run: id, ...body }: wire.ForkRequest, key: string) {
  const params = { ...run(id).params, ...keyed(key) };
  return typed<wire.Run>(client.POST("/runs/{run_id}/fork", { params, body: body as never }));
}
export const changeRun = (id: string, change: wire.RunChange) =>
  typed<wire.Run>(client.PATCH("/runs/{run_id}", { ...run(id), body: change as never }));
export const extendRun = (id: string, generations: number) =>
  typed<wire.Run>(client.POST("/runs/{run_id}/extend", { ...run(id), body: { generations } }));
/** A command goes on when its page is closed. */
export const commandRun = (id: string, verb: RunCommand) =>
  typed<wire.Run>(client.POST(`/runs/{run_id}/${verb}`, { ...run(id), keepalive: true }));
/** Move a run to the bin. */
export const deleteRun = (id: string) => typed<wire.Run>(client.DELETE("/runs/{run_id}", run(id)));
export const restoreRun = (id: string) => typed<wire.Run>(client.POST("/runs/{run_id}/restore", run(id)));

/** Creatures that people chose for the next generations to descend from. */
export const readChoices = (id: string) => success(client.GET("/runs/{run_id}/choices", run(id)));
export const chooseCreatures = (id: string, creatures: string[]) =>
  success(client.POST("/runs/{run_id}/choices", { ...run(id), body: { creatures } }));
/** Take back choices that do not count yet. */
export const takeBackChoices = (id: string, creatures: string[]) =>
  success(client.DELETE("/runs/{run_id}/choices", run(id, { creature: creatures })));

const joined = (measures: string[]) => (measures.length > 0 ? { measures: measures.join(",") } : {});

/** Columns come as bytes, which are smaller than JSON. */
const AS_COLUMNS = { headers: { Accept: COLUMNS }, parseAs: "arrayBuffer" } as const;
const decoded = async <T>(request: Promise<Answer<unknown>>) =>
  decodeColumns<T>(await typed<ArrayBuffer>(request));

/** The archive, now or after a generation, with columns of named measures; `after` skips older elites. */
export function readArchive(
  id: string,
  measures: string[] = [],
  when: { generation?: number; after?: number } = {},
) {
  const asked = { ...run(id, { ...joined(measures), ...when }), ...AS_COLUMNS };
  return decoded<wire.Archive>(client.GET("/runs/{run_id}/archive", asked));
}
/** The library gives nothing for an empty body. */
async function bytes(request: Promise<Answer<unknown>>): Promise<ArrayBuffer> {
  const found = await typed<unknown>(request);
  return found instanceof ArrayBuffer ? found : new ArrayBuffer(0);
}

/** The stored pose streams of the elites of cells, now or after a generation. */
export const readArchivePoses = (id: string, cells: number[], when: { generation?: number }) =>
  bytes(
    client.GET("/runs/{run_id}/archive/poses", {
      ...run(id, { cells: cells.join(), ...when }),
      parseAs: "arrayBuffer",
    }),
  );
/** The creatures that swim on the first page. */
export const readTank = (limit: number) => success(client.GET("/tank", { params: { query: { limit } } }));
/** The stored pose streams of some creatures. */
export const readTankPoses = (creatures: string[]) =>
  bytes(
    client.GET("/tank/poses", {
      params: { query: { creatures: creatures.join() } },
      parseAs: "arrayBuffer",
    }),
  );
/** Every elite that ever entered the archive, with columns of named measures. */
export function readHistory(id: string, measures: string[]) {
  const asked = { ...run(id, joined(measures)), ...AS_COLUMNS };
  return decoded<wire.History>(client.GET("/runs/{run_id}/archive/history", asked));
}
/** The archive of all creatures that ever entered, over other axes. */
export function readReprojection(id: string, axes: string[], measures: string[]) {
  const asked = { ...run(id, { axes: axes.join(","), ...joined(measures) }), ...AS_COLUMNS };
  return decoded<wire.Reprojection>(client.GET("/runs/{run_id}/archive/reprojection", asked));
}
/** All that ever entered the archive of a run with their parents, as columns: see decode/phylogeny.ts. */
export const readRunPhylogeny = (id: string) =>
  typed<ArrayBuffer>(client.GET("/runs/{run_id}/phylogeny", { ...run(id), ...AS_COLUMNS }));
/** A creature with all its ancestors and descendants. */
export const readCreaturePhylogeny = (sha: string) =>
  typed<ArrayBuffer>(client.GET("/creatures/{sha}/phylogeny", { ...creature(sha), ...AS_COLUMNS }));
/** Centroids of the cells of a CVT archive; null before its first checkpoint. */
export const readCentroids = async (id: string): Promise<number[][] | null> =>
  (await success(client.GET("/runs/{run_id}/archive/centroids", run(id)))).centroids;
export const readResults = (id: string) => typed<wire.Results>(client.GET("/runs/{run_id}/results", run(id)));
export const readGenerations = (id: string, points: number) =>
  success(client.GET("/runs/{run_id}/generations", run(id, { points })));
/** The newest log entries, oldest first, or those that follow an entry. */
export const readLog = (id: string, limit: number, after?: number) =>
  success(client.GET("/runs/{run_id}/log", run(id, { limit, after })));
export const readSpecies = (id: string) => success(client.GET("/runs/{run_id}/species", run(id)));
export const readTargets = (id: string) => success(client.GET("/runs/{run_id}/targets", run(id)));

export const readStatistics = (of: wire.ComparedRuns, measures: string) =>
  typed<wire.Statistics>(client.GET("/statistics", { params: { query: { ...of, measures } } }));
export const readSweeps = (limit: number, cursor?: string) =>
  typed<wire.SweepPage>(client.GET("/sweeps", { params: { query: { limit, cursor } } }));
export const readSweep = (id: string) => typed<wire.Sweep>(client.GET("/sweeps/{sweep_id}", sweep(id)));
export const readSweepSummary = (id: string, points: number) =>
  typed<wire.SweepSummary>(client.GET("/sweeps/{sweep_id}/summary", sweep(id, { points })));
export const readSweepCurves = (id: string, points: number) =>
  success(client.GET("/sweeps/{sweep_id}/curves", sweep(id, { points })));
export const estimateSweep = (request: wire.SweepRequest) =>
  success(client.POST("/sweeps/estimate", { body: request as never }));
export const createSweep = (request: wire.SweepRequest, key: string) =>
  typed<wire.Sweep>(client.POST("/sweeps", { params: keyed(key), body: request as never }));
export const commandSweep = (id: string, verb: SweepCommand) =>
  typed<wire.SweepChanged>(client.POST(`/sweeps/{sweep_id}/${verb}`, { ...sweep(id), keepalive: true }));
export const uncancelSweep = (id: string, runs: string[]) =>
  typed<wire.SweepChanged>(client.POST("/sweeps/{sweep_id}/uncancel", { ...sweep(id), body: { runs } }));
export const renameSweep = (id: string, name: string | null) =>
  typed<wire.Sweep>(client.PATCH("/sweeps/{sweep_id}", { ...sweep(id), body: { name } }));
/** Move the runs of a sweep to the bin, except active ones. */
export const deleteSweep = (id: string) =>
  typed<wire.SweepChanged>(client.DELETE("/sweeps/{sweep_id}", sweep(id)));
export const restoreSweep = (id: string) =>
  typed<wire.SweepChanged>(client.POST("/sweeps/{sweep_id}/restore", sweep(id)));

export const readCreature = (sha: string) =>
  typed<wire.Creature>(client.GET("/creatures/{sha}", creature(sha)));

/** Positions of the nodes of a creature's network. */
export const readNetwork = (sha: string) =>
  typed<wire.NetworkPositions>(client.GET("/creatures/{sha}/network.json", creature(sha)));

/** The length, stroke and sperm number of a creature. */
export const readStroke = (sha: string) =>
  typed<wire.Stroke | null>(client.GET("/creatures/{sha}/stroke.json", creature(sha)));

/** Typed quantities in SI units, with the scales of a body in lattice units. */
export const readUnits = (query: wire.UnitsQuery) => success(client.GET("/units", { params: { query } }));

/** The body plan of a creature, and the body at rest. */
export const readPlan = (sha: string) =>
  typed<wire.PlanDrawing>(client.GET("/creatures/{sha}/plan.json", creature(sha)));

const CHILDLESS: wire.Children = { total: 0, items: [] };

/** Ancestors of `depth` generations, and children; a share contains no children. */
export function readFamily(sha: string, depth: number): Promise<[wire.Ancestors, wire.Children]> {
  const up = success(client.GET("/creatures/{sha}/ancestors", creature(sha, { depth })));
  if (sharedSlug) return Promise.all([up, CHILDLESS]);
  return Promise.all([up, success(client.GET("/creatures/{sha}/children", creature(sha)))]);
}

/** Upload a creature file, JSON or HDF5, byte for byte. */
export function importCreature(file: Blob) {
  const body = { body: file as never, bodySerializer: () => file };
  const headers = { "Content-Type": file.type || "application/octet-stream" };
  return success(client.POST("/creatures", { ...body, headers }));
}

type CreatureFile = "replay" | "motion" | "evaluation" | "poses";

/** Read a file of a creature; null while a renderer prepares it. */
const readFile =
  (file: CreatureFile) =>
  (sha: string, headers: Record<string, string> = {}) =>
    whenReady<ArrayBuffer>(
      client.GET(`/creatures/{sha}/${file}`, { ...creature(sha), headers, parseAs: "arrayBuffer" }),
    );
export const readReplay = readFile("replay");
/** The replay made small, for a page without a server. */
export const readMotion = readFile("motion");
/** The inputs of the evaluation of a creature. */
export const readEvaluation = readFile("evaluation");
/** The pose stream, which may have to be made from a replay. */
export const readPoses = readFile("poses");
export const readCover = ({ slug, cover }: wire.Share) => readPoses(cover, { [SHARE_HEADER]: slug });
/** The verdict of the saved audit, null without one; requests no audit. */
export const readVerdict = (sha: string) => success(client.GET("/creatures/{sha}/verdict", creature(sha)));
/** The answer to an order: null while it is computed, `never` if nobody has ordered it. */
export type OrNever<T> = T | "never" | null;
export const orderAudit = (sha: string) => success(client.POST("/creatures/{sha}/audit", creature(sha)));
export const readAudit = (sha: string) =>
  orNever<wire.Audit>(client.GET("/creatures/{sha}/audit", creature(sha)));
/** Evaluate a creature again with the program that measured it. */
export const orderMeasurement = (sha: string) =>
  success(client.POST("/creatures/{sha}/measurement", creature(sha)));
export const readMeasurement = (sha: string) =>
  orNever<wire.Measurement>(client.GET("/creatures/{sha}/measurement", creature(sha)));

async function orNever<T>(request: Parameters<typeof whenReady<T>>[0]): Promise<OrNever<T>> {
  if ((await request).response.status === 204) return "never";
  return whenReady<T>(request);
}

const share = (slug: string) => ({ params: { path: { slug } } });
const page = (cursor?: string) => ({ params: { query: { cursor } } });

export const readShare = (slug: string): Promise<wire.Share> =>
  success(client.GET("/shares/{slug}", share(slug)));
export const readShares = (cursor?: string) => success(client.GET("/shares", page(cursor)));
export const readCommons = (cursor?: string) => success(client.GET("/commons", page(cursor)));
export const publish = (body: wire.ShareRequest): Promise<wire.Share> =>
  success(client.POST("/shares", { body }));
export const revoke = (slug: string): Promise<wire.Share> =>
  success(client.DELETE("/shares/{slug}", share(slug)));
