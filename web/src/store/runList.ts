/** The list of runs of a query; only the server knows its members. */

import { useEffect } from "preact/hooks";
import * as api from "../api/client";
import type { Run, RunPage, RunQuery } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { currentState, update, useStore } from "./store";
import { withList, withMore } from "./state";
import { useThrottled, useTick } from "./polling";

const PAGE = 30;
const MAX_PAGE = 200;
/** Lists whose order or contents change without events are read again in this interval. */
const REFRESH_MS = 5000;
const STABLE_ORDERS = ["created", "name", "experiment", "status"];

const useListVersion = () => useThrottled(useStore((state) => `${state.epoch} ${state.listVersion}`));

/** Keep the runs of a query in the store. */
export function useRunList(filters: RunQuery): Loaded<true> {
  const query = JSON.stringify(filters);
  const version = useListVersion();
  const hasActiveRuns = useStore((state) => state.listed.some((id) => changesSilently(state.runs.get(id))));
  const orderChanges = !STABLE_ORDERS.includes((filters.sort ?? "created").replace("-", ""));
  const tick = useTick(REFRESH_MS, hasActiveRuns || orderChanges);
  const { value, error } = useFetched(async () => {
    const { query: before, listed, eventCount: sentAt } = currentState();
    const known = before === query ? listed.length : 0;
    return { query, known, sentAt, page: await readUpTo(filters, known) };
  }, [query, version, tick]);
  useEffect(() => {
    if (value) update((state) => withList(state, value));
  }, [value]);
  const stored = useStore((state) => state.query) === query;
  return { value: stored || null, error };
}

/** True if the run has reasons to wait, rates or remaining times, which change without events. */
const changesSilently = (run?: Run) => run !== undefined && ["queued", "running"].includes(run.status);

/** The first page of a list, or as many pages as hold the known runs. */
export async function readUpTo(query: RunQuery, known: number): Promise<RunPage> {
  const limit = Math.min(MAX_PAGE, Math.max(PAGE, known));
  const page = await api.readRuns({ ...query, limit });
  const left = known - page.items.length;
  if (left <= 0 || !page.next) return page;
  const rest = await readUpTo({ ...query, cursor: page.next }, left);
  return { ...rest, items: [...page.items, ...rest.items] };
}

export async function loadMoreRuns(query: RunQuery): Promise<void> {
  const { next: cursor, eventCount: sentAt } = currentState();
  const page = await api.readRuns({ ...query, limit: PAGE, ...(cursor && { cursor }) });
  update((state) => withMore(state, { query: JSON.stringify(query), page, cursor, sentAt }));
}

export function useTags(): string[] {
  const { value } = useFetched(api.readTags, [useListVersion()]);
  return (value ?? []).map(({ tag }) => tag);
}
