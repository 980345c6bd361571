/** The list of runs that somebody looks at: what belongs to it, only the server says. */

import { useEffect } from "preact/hooks";
import * as api from "../api/client";
import type { Run, RunPage, RunQuery } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { currentState, dispatch, useStore } from "./store";
import { useThrottled } from "./throttle";
import { useTick } from "./refresh";

const PAGE = 30;
const MAX_PAGE = 200;
/** How often a list is read whose order or whose reasons to wait change without an event. */
const REFRESH_MS = 5000;
const STABLE_ORDERS = ["created", "name", "experiment", "status"];

/** Keeps the runs of a query listed, through every change that may concern them. */
export function useRunList(query: RunQuery): Loaded<true> {
  const asked = JSON.stringify(query);
  const news = useThrottled(useStore((state) => `${state.epoch} ${state.listVersion}`));
  const waits = useStore((state) => state.listed.some((id) => changesSilently(state.runs.get(id))));
  const moves = !STABLE_ORDERS.includes((query.sort ?? "created").replace("-", ""));
  const tick = useTick(REFRESH_MS, waits || moves);
  const { value, error } = useFetched(async () => {
    const { asked: before, listed, eventCount: sent } = currentState();
    const known = before === asked ? listed.length : 0;
    return { asked, known, sent, page: await readUpTo(query, known) };
  }, [asked, news, tick]);
  useEffect(() => {
    if (value) dispatch({ type: "list", ...value });
  }, [value]);
  // Read, and told to the store too: until then nobody knows that there are none.
  const told = useStore((state) => state.asked) === asked;
  return { value: told || null, error };
}

/** Reasons to wait, rates and times left come without events. */
const changesSilently = (run?: Run) => run !== undefined && ["queued", "running"].includes(run.status);

/** The first page of a list, or as many runs as are known of it, in pages. */
export async function readUpTo(query: RunQuery, known: number): Promise<RunPage> {
  const limit = Math.min(MAX_PAGE, Math.max(PAGE, known));
  const page = await api.readRuns({ ...query, limit });
  const left = known - page.items.length;
  if (left <= 0 || !page.next) return page;
  const rest = await readUpTo({ ...query, cursor: page.next }, left);
  return { ...rest, items: [...page.items, ...rest.items] };
}

export async function moreRuns(query: RunQuery): Promise<void> {
  const { next: cursor, eventCount: sent } = currentState();
  const page = await api.readRuns({ ...query, limit: PAGE, ...(cursor && { cursor }) });
  dispatch({ type: "more", asked: JSON.stringify(query), page, cursor, sent });
}

/** All tags there are, as often as any changes. */
export function useTags(): string[] {
  const news = useThrottled(useStore((state) => `${state.epoch} ${state.listVersion}`));
  const { value } = useFetched(api.readTags, [news]);
  return (value ?? []).map(({ tag }) => tag);
}
