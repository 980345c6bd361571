/** The view of an archive, from the address and the store. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import { type Elites, elitesByGeneration } from "../store/elites";
import { useCentroids, useMeasures, useHistory } from "../store/fetch";
import { setQuery } from "../store/router";
import { type MapAxis, FITNESS, axisOf, missingOf, namesOf, objectiveOf } from "./axes";
import { AGE, colourMeasure, colouringOf, coloursOf } from "./colouring";
import { type Layout, voronoiLayout } from "./layout";
import { type Slice, project } from "./projection";
import { PALETTES } from "../ui/colours";

export type ArchiveView = ReturnType<typeof useArchiveView>;

/** `at` is a generation of the past; null for the newest. */
export function useArchiveView(
  run: Run,
  archive: Archive,
  live: Elites,
  query: URLSearchParams,
  at: number | null,
) {
  const [x, y] = namesOf(archive, query.get("x"), query.get("y"));
  const colour = coloursOf(archive).find(([name]) => name === query.get("colour"))?.[0] ?? FITNESS;
  const palette = PALETTES.find((name) => name === query.get("palette")) ?? PALETTES[0]!;
  const shown = [x, y, colour, objectiveOf(run, archive)];
  const names = missingOf(archive, shown).filter((name) => name !== AGE);
  const liveMeasures = useMeasures(run.id, names, live);
  const { value: past, error } = useHistory(run.id, names, at);
  const measures = at !== null && past ? past.measures : liveMeasures;
  const elitesAt = useMemo(() => past && elitesByGeneration(past.history), [past]);
  const elites = useMemo(() => (at !== null && elitesAt ? elitesAt(at) : live), [at, elitesAt, live]);
  // Axes and colours follow the newest elites, so that they stay while the history is played.
  const axis = (name: string) => axisOf(name, archive, live, measures);
  const axes = useMemo(() => [axis(x), axis(y)] as const, [x, y, archive, live, measures]);
  const hidden = archive.axes.map(({ name }) => name).filter((name) => name !== x && name !== y);
  const requested = hidden.map((name) => query.get(`only.${name}`)).join();
  const slices = useMemo(
    () => hidden.map((name) => sliceOf(axis(name), query)),
    [x, y, archive, live, measures, requested],
  );
  const voronoi = useVoronoi(run.id, archive, [x, y]);
  const map = useMemo(() => project(elites, axes, slices, voronoi), [elites, axes, slices, voronoi]);
  // The projection onto even bins, also if the map shows Voronoi cells.
  const grid = useMemo(() => (voronoi ? project(elites, axes, slices) : map), [map, voronoi]);
  const generation = at ?? run.generation;
  const colouring = useMemo(() => {
    const measure = colourMeasure(colour, archive, measures, generation);
    const newest = at === null || colour === AGE ? map : project(live, axes, slices, voronoi);
    return colouringOf(measure, palette, newest.tiles);
  }, [colour, palette, archive, measures, generation, map]);
  const ready = at === null || past !== null;
  const choices = { axes, slices, colour, palette };
  return { ...choices, elites, measures, generation, ready, error, map, grid, colouring };
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
