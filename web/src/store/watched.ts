/** Curves of runs that are looked at beside others, and of nothing else of theirs. */

import type { GenerationEvent, Generations } from "../api/types";
import { type Curves, NO_CURVES, appendCurves, cutCurves, mergeCurves } from "./curves";

export interface Watched {
  /** Null until the first snapshot is there. */
  readonly curves: Curves | null;
  /** What events told since: the next snapshot may be older than they are. */
  readonly news: Curves;
  readonly watchers: number;
}

export type Watching = ReadonlyMap<string, Watched>;

const NOTHING: Watched = { curves: null, news: NO_CURVES, watchers: 0 };

/** One more looks at a run, or one less; what nobody looks at any more is forgotten. */
export function watched(watching: Watching, run: string, more: 1 | -1): Watching {
  const old = watching.get(run) ?? NOTHING;
  const next = new Map(watching).set(run, { ...old, watchers: old.watchers + more });
  if (next.get(run)!.watchers <= 0) next.delete(run);
  return next;
}

export function withHistory(watching: Watching, run: string, generations: Generations): Watching {
  return changed(watching, run, (old) => ({
    ...old,
    curves: mergeCurves(generations, old.news),
  }));
}

export function withNext(watching: Watching, event: GenerationEvent): Watching {
  return changed(watching, event.run, (old) => ({
    ...old,
    curves: old.curves && appendCurves(old.curves, event),
    news: appendCurves(old.news, event),
  }));
}

export function cutWatched(watching: Watching, run: string, generation: number): Watching {
  return changed(watching, run, (old) => ({
    ...old,
    curves: old.curves && cutCurves(old.curves, generation),
    news: cutCurves(old.news, generation),
  }));
}

/** The old curves until the next snapshot, of which nothing outlives that. */
export function doubtedWatched(watching: Watching): Watching {
  return new Map([...watching].map(([run, old]) => [run, { ...old, news: NO_CURVES }]));
}

function changed(watching: Watching, run: string, change: (old: Watched) => Watched): Watching {
  const old = watching.get(run);
  return old ? new Map(watching).set(run, change(old)) : watching;
}
