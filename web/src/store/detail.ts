/** The opened part of a run: its picture, and the news that its next snapshot may lack. */

import type { Archive, ElitesEvent, GenerationEvent, Generations } from "../api/types";
import { type Curves, NO_CURVES, appendCurves, cutCurves, mergeCurves } from "./curves";
import { type Elites, truncateElites, mergeElites, withElites } from "./elites";

export interface Detail {
  /** Null until the first snapshot is there, and where a run has no archive. */
  archive: Archive | null;
  elites: Elites;
  curves: Curves | null;
  /** What events told since the run was opened or the page reset: it outlives a snapshot. */
  recent: Recent;
  watchers: number;
}

interface Recent {
  readonly elites: Elites;
  readonly curves: Curves;
}

const NO_RECENT: Recent = { elites: new Map(), curves: NO_CURVES };

export const EMPTY_DETAIL: Detail = {
  archive: null,
  elites: new Map(),
  curves: null,
  recent: NO_RECENT,
  watchers: 0,
};

export function withElitesEvent(detail: Detail, event: ElitesEvent): Detail {
  const recent = { ...detail.recent, elites: withElites(detail.recent.elites, event) };
  return { ...detail, elites: withElites(detail.elites, event), recent };
}

export function withGenerationEvent(detail: Detail, event: GenerationEvent): Detail {
  const recent = { ...detail.recent, curves: appendCurves(detail.recent.curves, event) };
  return { ...detail, curves: detail.curves && appendCurves(detail.curves, event), recent };
}

export function withSnapshot(detail: Detail, archive: Archive | null, generations: Generations): Detail {
  const elites = archive ? mergeElites(archive, detail.recent.elites) : detail.elites;
  return { ...detail, archive, elites, curves: mergeCurves(generations, detail.recent.curves) };
}

export function truncate(detail: Detail, generation: number): Detail {
  const { elites, curves, recent } = detail;
  return {
    ...detail,
    elites: truncateElites(elites, generation),
    curves: curves && cutCurves(curves, generation),
    recent: {
      elites: truncateElites(recent.elites, generation),
      curves: cutCurves(recent.curves, generation),
    },
  };
}

/** The old picture until the next snapshot, of which nothing outlives that. */
export function withoutRecent(detail: Detail): Detail {
  return { ...detail, recent: NO_RECENT };
}
