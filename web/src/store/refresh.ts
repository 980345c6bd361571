/** What is asked for every few seconds, while somebody looks. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { useFetched } from "./fetch";
import { applyResponse, useStore } from "./store";

const WORKERS_MS = 3000;

/** Counts up every so often while the tab is visible. */
export function useTick(interval: number, wanted = true): number {
  const [tick, setTick] = useState(0);
  useEffect(() => {
    if (!wanted) return;
    const count = () => document.visibilityState === "visible" && setTick((old) => old + 1);
    const timer = setInterval(count, interval);
    document.addEventListener("visibilitychange", count);
    return () => {
      clearInterval(timer);
      document.removeEventListener("visibilitychange", count);
    };
  }, [interval, wanted]);
  return tick;
}

/** Workers and the queue, every few seconds and whenever a run changes its state. */
export function useWorkers() {
  const tick = useTick(WORKERS_MS);
  const news = useStore((state) => state.listVersion);
  const ask = async () => {
    const [workers, queue] = await Promise.all([api.readWorkers(), api.readQueue()]);
    return { workers, queue };
  };
  return useFetched(ask, [tick, news]);
}

/** Reasons to wait, rates and times left come without events. */
export function useRunRefresh(id: string, wanted: boolean): void {
  const tick = useTick(WORKERS_MS, wanted);
  useEffect(() => {
    if (tick === 0) return;
    applyResponse("response", api.readRun(id)).catch(() => {}); // The next one may come.
  }, [id, tick]);
}
