/** The log of a run; only the part that may have changed is read again. */

import { useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import type { LogEntry, Run } from "../api/types";
import { type Loaded, SLOW_MS, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./polling";
import { epochOf } from "./state";

/** Entries per answer of the server. */
const PAGE = 500;

interface LoadedLog extends Loaded<LogEntry[]> {
  /** Read all older entries; null if there are none. */
  loadEarlier: (() => void) | null;
}

/** Read when the state of the run changes, and regularly while it continues. */
export function useLog({ id, ...run }: Run): LoadedLog {
  const epoch = useStore((state) => epochOf(state, id));
  const { status, requested_state, attempt, warning, error, device } = run;
  const slow = useThrottled(run.generation, SLOW_MS);
  const known = useRef<LogEntry[]>([]);
  const [readAll, setReadAll] = useState(false);
  const loaded = useFetched(async () => {
    known.current = await extendLog(id, known.current, readAll);
    return known.current;
  }, [id, epoch, status, requested_state, attempt, warning, error, device, slow, readAll]);
  const loadEarlier = () => {
    known.current = [];
    setReadAll(true);
  };
  const hasEarlier = !readAll && (loaded.value?.length ?? 0) >= PAGE;
  return { ...loaded, loadEarlier: hasEarlier ? loadEarlier : null };
}

/** Add the newest entries to known ones; without known ones, read all or the last page. */
export async function extendLog(
  id: string,
  known: readonly LogEntry[],
  readAll: boolean,
): Promise<LogEntry[]> {
  // Newer entries of the current attempt may replace older ones.
  const finished = known.filter(({ attempt }) => attempt < known.at(-1)!.attempt);
  const after = finished.at(-1)?.id ?? (readAll ? 0 : undefined);
  return [...finished, ...(await readFollowing(id, after))];
}

async function readFollowing(id: string, after: number | undefined): Promise<LogEntry[]> {
  const { entries } = await api.readLog(id, PAGE, after);
  if (after === undefined || entries.length < PAGE) return entries;
  return [...entries, ...(await readFollowing(id, entries.at(-1)!.id))];
}
