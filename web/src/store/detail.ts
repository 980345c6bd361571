/** The opened part of a run: its picture, and the news that its next snapshot may lack. */

import type { Archive, ElitesEvent, GenerationEvent, Generations } from "../api/types";
import { type Curves, NO_CURVES, appendCurves, cutCurves, mergeCurves } from "./curves";
import { type Elites, cutElites, mergeElites, withElites } from "./elites";

export interface Detail {
  /** Null until the first snapshot is there, and where a run has no archive. */
  archive: Archive | null;
  elites: Elites;
  curves: Curves | null;
  /** What events told since the run was opened or the page reset: it outlives a snapshot. */
  news: News;
  watchers: number;
}

interface News {
  readonly elites: Elites;
  readonly curves: Curves;
}

const NO_NEWS: News = { elites: new Map(), curves: NO_CURVES };

export const NOTHING: Detail = {
  archive: null,
  elites: new Map(),
  curves: null,
  news: NO_NEWS,
  watchers: 0,
};

export function withChanges(detail: Detail, event: ElitesEvent): Detail {
  const news = { ...detail.news, elites: withElites(detail.news.elites, event) };
  return { ...detail, elites: withElites(detail.elites, event), news };
}

export function withCurvePoint(detail: Detail, event: GenerationEvent): Detail {
  const news = { ...detail.news, curves: appendCurves(detail.news.curves, event) };
  return { ...detail, curves: detail.curves && appendCurves(detail.curves, event), news };
}

export function replaced(detail: Detail, archive: Archive | null, generations: Generations): Detail {
  const elites = archive ? mergeElites(archive, detail.news.elites) : detail.elites;
  return { ...detail, archive, elites, curves: mergeCurves(generations, detail.news.curves) };
}

export function cut(detail: Detail, generation: number): Detail {
  const { elites, curves, news } = detail;
  return {
    ...detail,
    elites: cutElites(elites, generation),
    curves: curves && cutCurves(curves, generation),
    news: {
      elites: cutElites(news.elites, generation),
      curves: cutCurves(news.curves, generation),
    },
  };
}

/** The old picture until the next snapshot, of which nothing outlives that. */
export function doubted(detail: Detail): Detail {
  return { ...detail, news: NO_NEWS };
}
