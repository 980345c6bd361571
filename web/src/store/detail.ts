/** The archive and curves of a run that is shown, and events that its next snapshot may lack. */

import type { Archive, ElitesEvent, GenerationEvent, Generations } from "../api/types";
import { type Curves, NO_CURVES, appendCurves, cutCurves, mergeCurves } from "./curves";
import { type Changes, type Elites, truncateElites, mergeElites, withChanges, withElites } from "./elites";

export interface Detail {
  /** Null before the first snapshot with an archive. */
  archive: Archive | null;
  elites: Elites;
  /** Null before the first snapshot. */
  curves: Curves | null;
  /** Events since the run was opened or the store was reset. */
  recent: { readonly elites: Changes; readonly curves: Curves };
  viewers: number;
}

const NO_RECENT = { elites: new Map(), curves: NO_CURVES };

export const EMPTY_DETAIL: Detail = {
  archive: null,
  elites: new Map(),
  curves: null,
  recent: NO_RECENT,
  viewers: 0,
};

export function withElitesEvent(detail: Detail, event: ElitesEvent): Detail {
  const recent = { ...detail.recent, elites: withChanges(detail.recent.elites, event) };
  return { ...detail, elites: withElites(detail.elites, event), recent };
}

export function withGenerationEvent(detail: Detail, event: GenerationEvent): Detail {
  const recent = { ...detail.recent, curves: appendCurves(detail.recent.curves, event) };
  return { ...detail, curves: detail.curves && appendCurves(detail.curves, event), recent };
}

/** `archive` is null if the run has none or only its curves were fetched. */
export function withSnapshot(detail: Detail, archive: Archive | null, generations: Generations): Detail {
  const curves = mergeCurves(generations, detail.recent.curves);
  if (!archive) return { ...detail, curves };
  return { ...detail, archive, elites: mergeElites(archive, detail.recent.elites), curves };
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

/** Old data stays visible until the next snapshot, which replaces it. */
export const withoutRecent = (detail: Detail): Detail => ({ ...detail, recent: NO_RECENT });
