/** What parts of a run's page fetch beside its archive and its curves. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Run, SpeciesHistory } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useStore } from "./store";
import { useThrottled } from "./throttle";
import { epochOf } from "./reducer";

/** Runs that can be chosen to stand beside another one. */
const MAX_CHOICES = 100;
/** Between two looks at what grows with the generations. */
export const SLOW_MS = 4000;

/** The newest runs, the one that asks aside. */
export function useRunChoices(id: string): Loaded<Run[]> {
  return useFetched(async () => {
    const { items } = await api.readRuns({ limit: MAX_CHOICES });
    return items.filter((run) => run.id !== id);
  }, [id]);
}

/** Anew now and then while the run goes on, and at once when it ends. */
export function useSpecies({ id, status, generation }: Run): Loaded<SpeciesHistory> {
  const epoch = useStore((state) => epochOf(state, id));
  const calm = useThrottled(generation, SLOW_MS);
  return useFetched(() => api.readSpecies(id), [id, epoch, status, calm]);
}

/** The present moment, every second, while somebody has a reason to ask. */
export function useNow(asked: boolean): number {
  const [now, setNow] = useState(Date.now);
  useEffect(() => {
    if (!asked) return;
    setNow(Date.now());
    const timer = setInterval(() => setNow(Date.now()), 1000);
    return () => clearInterval(timer);
  }, [asked]);
  return now;
}
