/** Curves of runs that are looked at beside others, and of nothing else of theirs. */

import type { GenerationEvent, Generations } from "../api/types";
import { type Curves, NO_CURVES, appendCurves, cutCurves, mergeCurves } from "./curves";

export interface Watched {
  /** Null until the first snapshot is there. */
  readonly curves: Curves | null;
  /** What events told since: the next snapshot may be older than they are. */
  readonly recent: Curves;
  readonly watchers: number;
}

export type Watching = ReadonlyMap<string, Watched>;

const UNWATCHED: Watched = { curves: null, recent: NO_CURVES, watchers: 0 };

/** One more looks at a run, or one less; what nobody looks at any more is forgotten. */
export function changeWatchers(watching: Watching, run: string, more: 1 | -1): Watching {
  const old = watching.get(run) ?? UNWATCHED;
  const next = new Map(watching).set(run, { ...old, watchers: old.watchers + more });
  if (next.get(run)!.watchers <= 0) next.delete(run);
  return next;
}

export function withCurves(watching: Watching, run: string, generations: Generations): Watching {
  return changeRun(watching, run, (old) => ({
    ...old,
    curves: mergeCurves(generations, old.recent),
  }));
}

export function withGenerationEvent(watching: Watching, event: GenerationEvent): Watching {
  return changeRun(watching, event.run, (old) => ({
    ...old,
    curves: old.curves && appendCurves(old.curves, event),
    recent: appendCurves(old.recent, event),
  }));
}

export function truncate(watching: Watching, run: string, generation: number): Watching {
  return changeRun(watching, run, (old) => ({
    ...old,
    curves: old.curves && cutCurves(old.curves, generation),
    recent: cutCurves(old.recent, generation),
  }));
}

/** The old curves until the next snapshot, of which nothing outlives that. */
export function withoutRecent(watching: Watching): Watching {
  return new Map([...watching].map(([run, old]) => [run, { ...old, recent: NO_CURVES }]));
}

function changeRun(watching: Watching, run: string, change: (old: Watched) => Watched): Watching {
  const old = watching.get(run);
  return old ? new Map(watching).set(run, change(old)) : watching;
}
