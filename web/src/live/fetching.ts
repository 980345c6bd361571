/** What components fetch: once when they appear, and again when the store asks for it. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Archive, Experiment, Results, Run } from "../api/types";
import type { Elites } from "./elites";
import { current, dispatch, useLive } from "./live";
import { epochOf } from "./store";

/** Whether a run searches for elites; others measure, and their result is a table. */
export const hasArchive = ({ spec }: Run) => "search" in spec;

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

/** How often features of a changing archive are asked for, at most. */
const FRESH_MS = 2000;

/** What was recorded of the elites under some names: by name, then by creature. */
export function useFeatures(id: string, names: string[], elites: Elites): Features {
  const epoch = useLive((state) => epochOf(state, id));
  const asked = names.join(",");
  const present = usePaced(asked ? elites : null);
  const { value } = useFetched(
    async () => (asked ? columnsOf(await api.readArchive(id, asked.split(","))) : NONE),
    [id, epoch, asked, present],
  );
  return value ?? NONE;
}

type Features = ReadonlyMap<string, ReadonlyMap<string, number>>;

const NONE: Features = new Map();

function columnsOf({ creature, features }: Archive): Features {
  const columns = Object.entries(features).map(([name, values]) => {
    const known = values.flatMap((value, i): [string, number][] =>
      value === null ? [] : [[creature[i]!, value]],
    );
    return [name, new Map(known)] as const;
  });
  return new Map(columns);
}

/** A value that is let through now and then, the last one always. */
function usePaced<T>(value: T): T {
  const [paced, setPaced] = useState(value);
  const last = useRef(-Infinity);
  useEffect(() => {
    if (Object.is(value, paced)) return;
    const wait = Math.max(0, last.current + FRESH_MS - performance.now());
    const timer = setTimeout(() => {
      last.current = performance.now();
      setPaced(() => value);
    }, wait);
    return () => clearTimeout(timer);
  }, [value, paced]);
  return paced;
}

/** Keeps the table of a run fetched: anew after every row, rewind and reset. */
export function useResults(id: string): Loaded<Results> {
  const epoch = useLive((state) => epochOf(state, id));
  const told = useLive((state) => state.tables.get(id));
  return useFetched(() => api.readResults(id), [id, epoch, told]);
}
