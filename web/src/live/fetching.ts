/** What components fetch: once when they appear, and again when the store asks for it. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Experiment, Results, Run } from "../api/types";
import { current, dispatch, useLive } from "./live";
import { epochOf } from "./store";

/** Whether a run searches for elites; others measure, and their result is a table. */
export const hasArchive = ({ spec }: Run) => "archive" in spec;

const PAGE = 30;
/** Points of a curve that a snapshot carries; a screen shows no more. */
const POINTS = 1000;

export interface Loaded<T> {
  value: T | null;
  error: string | null;
}

/** The answer to a request that is made again whenever one of `inputs` changes. */
export function useFetched<T>(fetch: () => Promise<T>, inputs: unknown[]): Loaded<T> {
  const [loaded, setLoaded] = useState<Loaded<T>>({ value: null, error: null });
  useEffect(() => {
    let wanted = true;
    fetch()
      .then((value) => wanted && setLoaded({ value, error: null }))
      .catch((error) => wanted && setLoaded((old) => ({ ...old, error: messageOf(error) })));
    return () => {
      wanted = false;
    };
  }, inputs);
  return loaded;
}

let experiments: Promise<Experiment[]> | null = null;

/** Experiments do not change while a server runs: fetched once a tab, unless that failed. */
export function useExperiments(): Loaded<Experiment[]> {
  return useFetched(() => {
    experiments ??= api.readExperiments();
    experiments.catch(() => (experiments = null));
    return experiments;
  }, []);
}

/** Keeps the first page of runs fetched; what comes later, events tell. */
export function useRunList(): Loaded<true> {
  const epoch = useLive((state) => state.epoch);
  return useFetched(async () => {
    dispatch({ type: "list", page: await api.readRuns(null, PAGE), more: false });
    return true as const;
  }, [epoch]);
}

export async function moreRuns(): Promise<void> {
  const page = await api.readRuns(current().next, PAGE);
  dispatch({ type: "list", page, more: true });
}

/** Keeps one run, its archive and its curves fetched, after every rewind and reset anew. */
export function useRunDetail(id: string): Loaded<true> {
  const epoch = useLive((state) => epochOf(state, id));
  return useFetched(async () => {
    dispatch({ type: "open", run: id });
    const run = await api.readRun(id);
    const [archive, generations] = await Promise.all([
      hasArchive(run) ? api.readArchive(id) : null,
      api.readGenerations(id, POINTS),
    ]);
    if (epoch === epochOf(current(), id)) dispatch({ type: "run", run });
    dispatch({ type: "snapshot", run: id, epoch, archive, generations });
    return true as const;
  }, [id, epoch]);
}

/** Keeps the table of a run fetched: anew after every row, rewind and reset. */
export function useResults(id: string): Loaded<Results> {
  const epoch = useLive((state) => epochOf(state, id));
  const told = useLive((state) => state.tables.get(id));
  return useFetched(() => api.readResults(id), [id, epoch, told]);
}
