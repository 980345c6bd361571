/** The view of an archive, from the address and the store, with the elites of one verdict if asked for. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import { type Elites, type Elite, elitesByGeneration } from "../store/elites";
import { useCentroids, useMeasures, useHistory } from "../store/fetch";
import { setQuery } from "../store/router";
import { type MapAxis, FITNESS, axisOf, choicesOf, missingOf, namesOf, objectiveOf } from "./axes";
import { AGE, colourMeasure, colouringOf, coloursOf } from "./colouring";
import { type Layout, voronoiLayout } from "./layout";
import { type Slice, project } from "./projection";
import { ofQuery, useReprojected, withComponents } from "./reprojection";
import { PALETTES } from "../ui/colours";
import { text as words } from "../ui/text";
import { text } from "./text";

export type ArchiveView = ReturnType<typeof useArchiveView>;

/** `at` is a generation of the past; null for the newest. */
export function useArchiveView(
  run: Run,
  own: Archive,
  live: Elites,
  query: URLSearchParams,
  at: number | null,
) {
  const of = ofQuery(query);
  const named = of === "history" ? withComponents(own, null) : own;
  const [x, y] = namesOf(named, query.get("x"), query.get("y"));
  const colour = coloursOf(own).find(([name]) => name === query.get("colour"))?.[0] ?? FITNESS;
  const palette = PALETTES.find((name) => name === query.get("palette")) ?? PALETTES[0]!;
  const anew: [string, string] | null = of === "history" ? [x, y] : null;
  const wanted = anew ? [] : [x, y, colour, objectiveOf(run, own)];
  const elected = useElected(run, own, live, wanted, anew ? null : at);
  const reprojected = useReprojected(run, own, anew, colour);
  const { archive, newest, elitesAt, measures, error } = reprojected ?? elected;
  const trust = anew ? "" : trustOf(query);
  const all = useMemo(() => (at !== null && elitesAt ? elitesAt(at) : newest), [at, elitesAt, newest]);
  const elites = useMemo(() => withVerdict(all, trust), [all, trust]);
  // Axes and colours follow the newest elites, so that they stay while the history is played.
  const axis = (name: string) => axisOf(name, archive, newest, measures);
  const axes = useMemo(() => [axis(x), axis(y)] as const, [x, y, archive, newest, measures]);
  const others = reprojected ? [] : archive.axes.map(({ name }) => name);
  const hidden = others.filter((name) => name !== x && name !== y);
  const given = hidden.map((name) => query.get(`only.${name}`)).join();
  const from = [x, y, archive, newest, measures, given];
  const slices = useMemo(() => hidden.map((name) => sliceOf(axis(name), query)), from);
  const voronoi = useVoronoi(run.id, archive, [x, y]);
  const map = useMemo(() => project(elites, axes, slices, voronoi), [elites, axes, slices, voronoi]);
  // Even bins, also if the map shows Voronoi cells.
  const grid = useMemo(() => (voronoi ? project(elites, axes, slices) : map), [map, voronoi]);
  const generation = at ?? run.generation;
  const colouring = useMemo(() => {
    const measure = colourMeasure(colour, archive, measures, generation);
    const last = at === null || colour === AGE ? map : project(newest, axes, slices, voronoi);
    return colouringOf(measure, palette, last.tiles);
  }, [colour, palette, archive, measures, generation, map]);
  const ready = reprojected ? elitesAt !== null : at === null || elitesAt !== null;
  const shown = {
    archive,
    of,
    trust,
    reprojection: reprojected?.reprojection ?? null,
    choices: choicesOf(named),
  };
  const drawn = { axes, slices, colour, palette, map, grid, colouring };
  return { ...shown, ...drawn, elites, measures, generation, ready, error };
}

/** The elites of the archive itself. */
function useElected(run: Run, archive: Archive, newest: Elites, shown: string[], at: number | null) {
  const names = missingOf(archive, shown).filter((name) => name !== AGE);
  const live = useMeasures(run.id, names, newest);
  const { value: past, error } = useHistory(run.id, names, at);
  const measures = at !== null && past ? past.measures : live;
  const elitesAt = useMemo(() => past && elitesByGeneration(past.history), [past]);
  return { archive, newest, elitesAt, measures, error };
}

/** The bins in the address, `3-7`; by default all. */
function sliceOf(axis: MapAxis, query: URLSearchParams): Slice {
  const [, from, to] = /^(\d+)-(\d+)$/.exec(query.get(`only.${axis.name}`) ?? "") ?? [];
  const last = axis.bins - 1;
  if (from === undefined) return { axis, from: 0, to: last };
  const low = Math.min(last, Number(from));
  return { axis, from: low, to: Math.max(low, Math.min(last, Number(to))) };
}

export function setSlice(axis: MapAxis, from: number, to: number): void {
  const all = from === 0 && to === axis.bins - 1;
  setQuery({ [`only.${axis.name}`]: all ? null : `${from}-${to}` });
}

/** The Voronoi cells, if the axes are both descriptors of a CVT. */
function useVoronoi(id: string, archive: Archive, names: [string, string]): Layout | null {
  const [x, y] = names.map((name) => archive.axes.findIndex((axis) => axis.name === name));
  const shown = archive.kind === "cvt" && archive.axes.length === 2 && x! >= 0 && y! >= 0;
  const centroids = useCentroids(id, shown);
  const [layout, setLayout] = useState<Layout | null>(null);
  useEffect(() => {
    setLayout(null);
    if (!shown || !centroids) return;
    const points = centroids.map((centroid) => [centroid[x!]!, 1 - centroid[y!]!] as const);
    let current = true;
    // Load the library on demand, because few archives have Voronoi cells.
    void import("d3-delaunay").then(({ Delaunay }) => {
      if (current) setLayout(voronoiLayout(points, Delaunay));
    });
    return () => {
      current = false;
    };
  }, [shown, centroids, x, y]);
  return layout;
}

const VERDICTS: Record<string, Elite["trusted"]> = { trusted: true, distrusted: false, unaudited: null };

export const TRUST_CHOICES = [
  ["", text.anyVerdict],
  ["trusted", words.trusted],
  ["distrusted", words.notTrusted],
  ["unaudited", words.notAudited],
] as const;

/** The choice in the address; unknown ones are ignored. */
export function trustOf(query: URLSearchParams): string {
  const given = query.get("trust") ?? "";
  return Object.hasOwn(VERDICTS, given) ? given : "";
}

/** The elites with a verdict; all of them without a choice. */
export function withVerdict(elites: Elites, choice: string): Elites {
  const verdict = VERDICTS[choice];
  if (verdict === undefined) return elites;
  return new Map([...elites].filter(([, { trusted }]) => trusted === verdict));
}
