/** Statistics of runs that have ended, read again when one of them changes. */

import * as api from "../api/client";
import type { ComparedRuns, Statistics } from "../api/types";
import { type Loaded, useFetched } from "./fetch";
import { useThrottled } from "./polling";
import { type State, epochOf } from "./state";
import { useStore } from "./store";

export function useStatistics(of: ComparedRuns, measures: string): Loaded<Statistics> {
  const version = useThrottled(useStore((state) => versionOf(state, of)));
  const asked = Object.values(of).join();
  return useFetched(() => api.readStatistics(of, measures), [asked, version, measures]);
}

function versionOf(state: State, of: ComparedRuns): string {
  if ("sweep" in of) return `${state.epoch} ${state.sweepVersions.get(of.sweep) ?? 0}`;
  return of.runs
    .split(",")
    .map((id) => epochOf(state, id))
    .join();
}
