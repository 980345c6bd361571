/** What components fetch: once when they appear, and again when the store asks for it. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Archive, Experiment, History, Results, Run } from "../api/types";
import type { Curves } from "./curves";
import type { Elites } from "./elites";
import { applyResponse, currentState, dispatch, useStore } from "./store";
import { retain } from "./retain";
import { useThrottled } from "./throttle";
import { poll } from "./polling";
import { epochOf } from "./reducer";

/** Whether a run searches for elites; others measure, and their result is a table. */
export const hasArchive = ({ spec }: Run) => "search" in spec;

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

/** Keeps one run, its archive and its curves fetched, after every rewind and reset anew. */
export function useRunDetail(id: string): Loaded<true> {
  const epoch = useStore((state) => epochOf(state, id));
  const binned = useStore((state) => Boolean(state.runs.get(id)?.deleted_at));
  useEffect(() => retain("open", [id]), [id]);
  return useFetched(async () => {
    const run = await applyResponse("response", api.readRun(id));
    if (run.deleted_at) return true as const;
    const [archive, generations] = await Promise.all([
      hasArchive(run) ? api.readArchive(id) : null,
      api.readGenerations(id, POINTS),
    ]);
    dispatch({ type: "snapshot", run: id, epoch, archive, generations });
    return true as const;
  }, [id, epoch, binned]);
}

/** Curves of several runs by their ids, fetched and alive while somebody looks at them. */
export function useCurvesOf(ids: string[]): Loaded<ReadonlyMap<string, Curves>> {
  const asked = ids.join();
  const epochs = useStore((state) => ids.map((id) => epochOf(state, id)).join());
  useEffect(() => retain("watch", ids), [asked]);
  const { value, error } = useFetched(() => Promise.all(ids.map(readCurves)), [asked, epochs]);
  const watching = useStore((state) => state.watching);
  const known = ids.flatMap((id): [string, Curves][] => {
    const curves = watching.get(id)?.curves;
    return curves ? [[id, curves]] : [];
  });
  return { value: value || known.length > 0 ? new Map(known) : null, error };
}

/** The run itself comes along: whoever shows its curves names it. */
async function readCurves(id: string): Promise<true> {
  const epoch = epochOf(currentState(), id);
  const run = applyResponse("response", api.readRun(id));
  const [generations] = await Promise.all([api.readGenerations(id, POINTS), run]);
  dispatch({ type: "curves", run: id, epoch, generations });
  return true;
}

/**
 * What was recorded of the elites under some names: by name, then by creature. Of an archive that
 * changes, only what is new is asked for; who has left stays known.
 */
export function useMeasures(id: string, names: string[], elites: Elites): Measures {
  const epoch = useStore((state) => epochOf(state, id));
  const asked = names.join(",");
  const present = useThrottled(asked ? elites : null);
  const of = `${id} ${epoch} ${asked}`;
  const known = useRef<{ of: string; after?: number; measures: Measures }>({ of, measures: NO_MEASURES });
  const { value } = useFetched(async () => {
    if (!asked) return NO_MEASURES;
    const { after, measures } = known.current.of === of ? known.current : { measures: NO_MEASURES };
    const archive = await api.readArchive(id, asked.split(","), { after });
    known.current = { of, after: archive.generation, measures: mergeMeasures(measures, measuresOf(archive)) };
    return known.current.measures;
  }, [of, present]);
  return value ?? NO_MEASURES;
}

type Measures = ReadonlyMap<string, ReadonlyMap<string, number>>;

const NO_MEASURES: Measures = new Map();

function mergeMeasures(known: Measures, added: Measures): Measures {
  const column = ([name, values]: [string, ReadonlyMap<string, number>]) =>
    [name, new Map([...(known.get(name) ?? []), ...values])] as const;
  return new Map([...added].map(column));
}

function measuresOf({ creature, measures }: Pick<Archive, "creature" | "measures">): Measures {
  const columns = Object.entries(measures).map(([name, values]) => {
    const known = values.flatMap((value, i): [string, number][] =>
      value === null ? [] : [[creature[i]!, value]],
    );
    return [name, new Map(known)] as const;
  });
  return new Map(columns);
}

interface Past {
  history: History;
  measures: Measures;
}

/**
 * Every elite that ever entered, once a generation of the past is wanted; anew when one is
 * wanted that the run had not come to.
 */
export function useHistory(id: string, names: string[], at: number | null): Loaded<Past | null> {
  const epoch = useStore((state) => epochOf(state, id));
  const [turn, setTurn] = useState(0);
  const asked = names.join(",");
  const wanted = at !== null;
  const loaded = useFetched(async () => {
    if (!wanted) return null;
    const history = await api.readHistory(id, asked ? asked.split(",") : []);
    return { history, measures: measuresOf(history) };
  }, [id, epoch, asked, wanted, turn]);
  const outgrown = wanted && loaded.value !== null && at > loaded.value.history.generation;
  useEffect(() => {
    if (outgrown) setTurn((count) => count + 1);
  }, [outgrown]);
  return loaded;
}

/** Where the cells of a CVT are; asked for until the first checkpoint tells. */
export function useCentroids(id: string, wanted: boolean): number[][] | null {
  const [centroids, setCentroids] = useState<number[][] | null>(null);
  useEffect(() => {
    setCentroids(null);
    if (!wanted) return;
    const silent = () => {}; // Meanwhile the map shows even bins.
    return poll(() => api.readCentroids(id), { value: setCentroids, note: silent, error: silent });
  }, [id, wanted]);
  return centroids;
}

/** Keeps the table of a run fetched: anew after every row, rewind and reset. */
export function useResults(id: string): Loaded<Results> {
  const epoch = useStore((state) => epochOf(state, id));
  const told = useStore((state) => state.tableVersions.get(id));
  return useFetched(() => api.readResults(id), [id, epoch, told]);
}
