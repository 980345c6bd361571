/** The journal of a run: read anew only as far as it may have changed. */

import { useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import type { LogEntry, Run } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./throttle";
import { SLOW_MS } from "./runPage";
import { epochOf } from "./reducer";

/** As many entries as the server tells at once. */
const PAGE = 500;

interface LoadedLog extends Loaded<LogEntry[]> {
  /** Where there may be older entries: reads them all. */
  earlier: (() => void) | null;
}

/** Anew whenever the run's standing changes, and now and then while it goes on. */
export function useLog({ id, ...run }: Run): LoadedLog {
  const epoch = useStore((state) => epochOf(state, id));
  const { status, requested_state, attempt, warning, error, device } = run;
  const calm = useThrottled(run.generation, SLOW_MS);
  const known = useRef<LogEntry[]>([]);
  const [whole, setWhole] = useState(false);
  const loaded = useFetched(async () => {
    known.current = await extendLog(id, known.current, whole);
    return known.current;
  }, [id, epoch, status, requested_state, attempt, warning, error, device, calm, whole]);
  const earlier = () => {
    known.current = [];
    setWhole(true);
  };
  const more = !whole && (loaded.value?.length ?? 0) >= PAGE;
  return { ...loaded, earlier: more ? earlier : null };
}

/** What is known, with the newest entries; with nothing known, all of them or the last ones. */
export async function extendLog(id: string, known: readonly LogEntry[], whole: boolean): Promise<LogEntry[]> {
  // Entries of the attempt at hand are dropped again where newer ones say the same.
  const kept = known.filter(({ attempt }) => attempt < known.at(-1)!.attempt);
  const after = kept.at(-1)?.id ?? (whole ? 0 : undefined);
  return [...kept, ...(await readFollowing(id, after))];
}

async function readFollowing(id: string, after: number | undefined): Promise<LogEntry[]> {
  const { entries } = await api.readLog(id, PAGE, after);
  if (after === undefined || entries.length < PAGE) return entries;
  return [...entries, ...(await readFollowing(id, entries.at(-1)!.id))];
}
