/** The creatures of the tank, read again as runs go on. */

import * as api from "../api/client";
import type { Tank } from "../api/types";
import { SLOW_MS, type Loaded, useFetched } from "./fetch";
import { useThrottled } from "./polling";
import { useStore } from "./store";

export function useTank(limit: number): Loaded<Tank> {
  // Every event of a run may bring new elites, or a run into or out of the bin.
  const changed = useThrottled(
    useStore((state) => state.eventCount),
    SLOW_MS,
  );
  const { value, error } = useFetched(() => api.readTank(limit), [limit, changed]);
  return { value, error: value ? null : error };
}
