/** Hooks that fetch data when a component appears and when the store asks for it again. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Experiment, History, Reprojection, Results, Run, SpeciesHistory } from "../api/types";
import type { Curves } from "./curves";
import { type Elites, type Measures, measuresOf } from "./elites";
import { usePolled, useThrottled, useTick } from "./polling";
import { epochOf, withSnapshot } from "./state";
import { applyResponse, currentState, retain, update, useEach, useStore } from "./store";

/** True if a run searches for elites; others produce a table of results. */
export const hasArchive = ({ spec }: Run) => "search" in spec;

/** Points per curve, as many as a screen resolves. */
const POINTS = 1000;
/** Runs to choose from for comparison. */
const MAX_CHOICES = 100;
/** Intervals of updates without events, and of data that grows with the generations. */
const REFRESH_MS = 3000;
export const SLOW_MS = 4000;
/** Interval of re-projections, which read every creature that ever entered. */
const REPROJECTION_MS = 15_000;

export interface Loaded<T> {
  value: T | null;
  error: string | null;
}

/**
 * The answer to a request that is repeated when one of `inputs` changes, or some time after.
 *
 * It stays until a newer one comes. So it may be one to former inputs.
 */
export function useFetched<T>(fetch: () => Promise<T>, inputs: unknown[], delayMs = 0): Loaded<T> {
  const [loaded, setLoaded] = useState<Loaded<T>>({ value: null, error: null });
  const send = useRef(inOrder<T>((answer) => setLoaded((old) => ({ ...old, ...answer })))).current;
  useEffect(() => {
    if (delayMs === 0) return send(fetch());
    const timer = setTimeout(() => send(fetch()), delayMs);
    return () => clearTimeout(timer);
  }, inputs);
  return loaded;
}

/**
 * Show the answers to repeated requests; an answer that a newer one has overtaken is dropped.
 *
 * An answer is shown though a newer request is on its way: a server may need longer for it than the time
 * between two requests, and then none would ever be shown.
 */
export function inOrder<T>(show: (answer: Partial<Loaded<T>>) => void): (request: Promise<T>) => void {
  let sent = 0;
  let shown = 0;
  return (request) => {
    const place = ++sent;
    const pass = (answer: Partial<Loaded<T>>) => {
      if (place < shown) return;
      shown = place;
      show(answer);
    };
    request.then(
      (value) => pass({ value, error: null }),
      (error) => pass({ error: messageOf(error) }),
    );
  };
}

const useEpoch = (id: string) => useStore((state) => epochOf(state, id));

let experiments: Promise<Experiment[]> | null = null;

/** Experiments do not change while a server runs: they are fetched once per tab. */
export function useExperiments(): Loaded<Experiment[]> {
  return useFetched(() => {
    experiments ??= api.readExperiments();
    experiments.catch(() => (experiments = null));
    return experiments;
  }, []);
}

/** Keep a run, its archive and its curves in the store. */
export function useRunDetail(id: string): Loaded<true> {
  const epoch = useEpoch(id);
  const inBin = useStore((state) => Boolean(state.runs.get(id)?.deleted_at));
  useEffect(() => retain([id]), [id]);
  return useFetched(() => readDetail(id, true), [id, epoch, inBin]);
}

/** Keep the curves of several runs in the store. */
export function useCurvesOf(ids: string[]): Loaded<ReadonlyMap<string, Curves>> {
  const joined = ids.join();
  const epochs = useStore((state) => ids.map((id) => epochOf(state, id)).join());
  useEffect(() => retain(ids), [joined]);
  const read = () => Promise.all(ids.map((id) => readDetail(id, false)));
  const { value, error } = useFetched(read, [joined, epochs]);
  const curves = useEach(ids, ({ details }, id) => details.get(id)?.curves);
  const known = ids.flatMap((id, i): [string, Curves][] => (curves[i] ? [[id, curves[i]]] : []));
  return { value: value || known.length > 0 ? new Map(known) : null, error };
}

/** The archive of a run in the bin is not read. */
async function readDetail(id: string, withArchive: boolean): Promise<true> {
  const epoch = epochOf(currentState(), id);
  const run = await applyResponse("response", api.readRun(id));
  if (withArchive && run.deleted_at) return true;
  const [archive, generations] = await Promise.all([
    withArchive && hasArchive(run) ? api.readArchive(id) : null,
    api.readGenerations(id, POINTS),
  ]);
  update((state) => withSnapshot(state, id, epoch, archive, generations));
  return true;
}

/** Recorded measures of elites by name and creature; later requests fetch new elites only. */
export function useMeasures(id: string, names: string[], elites: Elites): Measures {
  const epoch = useEpoch(id);
  const joined = names.join(",");
  const throttled = useThrottled(joined ? elites : null);
  const key = `${id} ${epoch} ${joined}`;
  const known = useRef<{ key: string; after?: number; measures: Measures }>({ key, measures: NONE });
  const { value } = useFetched(async () => {
    if (!joined) return NONE;
    const { after, measures } = known.current.key === key ? known.current : { measures: NONE };
    const archive = await api.readArchive(id, joined.split(","), { after });
    const merged = mergeMeasures(measures, measuresOf(archive));
    known.current = { key, after: archive.generation, measures: merged };
    return merged;
  }, [key, throttled]);
  return value ?? NONE;
}

const NONE: Measures = new Map();

function mergeMeasures(known: Measures, added: Measures): Measures {
  const column = ([name, values]: [string, ReadonlyMap<string, number>]) =>
    [name, new Map([...(known.get(name) ?? []), ...values])] as const;
  return new Map([...added].map(column));
}

interface Past {
  history: History;
  measures: Measures;
}

/** The history of an archive, if a past generation is shown; read again for a newer one. */
export function useHistory(id: string, names: string[], at: number | null): Loaded<Past | null> {
  const epoch = useEpoch(id);
  const [retries, setRetries] = useState(0);
  const joined = names.join(",");
  const isPast = at !== null;
  const loaded = useFetched(async () => {
    if (!isPast) return null;
    const history = await api.readHistory(id, joined ? joined.split(",") : []);
    return { history, measures: measuresOf(history) };
  }, [id, epoch, joined, isPast, retries]);
  const outdated = isPast && loaded.value !== null && at > loaded.value.history.generation;
  useEffect(() => {
    if (outdated) setRetries((count) => count + 1);
  }, [outdated]);
  return loaded;
}

interface Reprojected {
  reprojection: Reprojection;
  measures: Measures;
}

/** The archive of all creatures that ever entered, over other axes; null without axes. */
export function useReprojection(
  { id, generation }: Run,
  axes: string[] | null,
  names: string[],
): Loaded<Reprojected | null> {
  const slow = useThrottled(axes ? generation : null, REPROJECTION_MS);
  const read = async () => {
    if (!axes) return null;
    const reprojection = await api.readReprojection(id, axes, names);
    return { reprojection, measures: measuresOf(reprojection) };
  };
  return useFetched(read, [id, useEpoch(id), axes?.join(), names.join(), slow]);
}

/** Centroids of the cells of a CVT; null before the first checkpoint, when the map shows even bins. */
export const useCentroids = (id: string, enabled: boolean) =>
  usePolled(enabled ? () => api.readCentroids(id) : null, [id, enabled]).value;

/** The results table of a run, updated by events. */
export function useResults(id: string): Loaded<Results> {
  const version = useThrottled(useStore((state) => state.tableVersions.get(id)));
  return useFetched(() => api.readResults(id), [id, useEpoch(id), version]);
}

/** The newest other runs. */
export function useRunChoices(id: string): Loaded<Run[]> {
  return useFetched(async () => {
    const { items } = await api.readRuns({ limit: MAX_CHOICES });
    return items.filter((run) => run.id !== id);
  }, [id]);
}

export function useSpecies({ id, status, generation }: Run): Loaded<SpeciesHistory> {
  const slow = useThrottled(generation, SLOW_MS);
  return useFetched(() => api.readSpecies(id), [id, useEpoch(id), status, slow]);
}

/** Workers and the queue, updated by the clock and by changes of runs. */
export function useWorkers() {
  const tick = useTick(REFRESH_MS);
  const version = useThrottled(useStore((state) => state.listVersion));
  const read = async () => {
    const [workers, queue] = await Promise.all([api.readWorkers(), api.readQueue()]);
    return { workers, queue };
  };
  return useFetched(read, [tick, version]);
}

/** Update reasons to wait, rates and remaining times, which change without events. */
export function useRunRefresh(id: string, enabled: boolean): void {
  const tick = useTick(REFRESH_MS, enabled);
  useEffect(() => {
    if (tick === 0) return;
    applyResponse("response", api.readRun(id)).catch(() => {}); // The next request may succeed.
  }, [id, tick]);
}
