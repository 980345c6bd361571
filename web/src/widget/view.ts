/** What a map in a notebook shows, from the fields of its model. */

import { Delaunay } from "d3-delaunay";
import { type Measures, axisOf, namesOf } from "../archive/axes";
import { colourMeasure, colouringOf, coloursOf } from "../archive/colouring";
import { voronoiLayout } from "../archive/layout";
import { project } from "../archive/projection";
import { type Elites, mergeElites } from "../store/elites";
import { PALETTES } from "../ui/colours";
import type { Shown } from "./model";

export interface Choice {
  x: string | null;
  y: string | null;
  colour: string;
}

export function viewOf(archive: Shown, { x, y, colour }: Choice) {
  const elites: Elites = mergeElites(archive, new Map());
  const measures = measuresOf(archive);
  const names = namesOf(archive, x, y);
  const axes = [
    axisOf(names[0], archive, elites, measures),
    axisOf(names[1], archive, elites, measures),
  ] as const;
  const projection = project(elites, axes, [], cellsOf(archive, names));
  const known = coloursOf(archive).some(([name]) => name === colour);
  const measure = colourMeasure(known ? colour : "fitness", archive, measures, archive.generation);
  const colouring = colouringOf(measure, PALETTES[0]!, projection.tiles);
  return { elites, axes, projection, colouring };
}

function measuresOf({ measures, creature }: Shown): Measures {
  const columns = Object.entries(measures ?? {});
  return new Map(
    columns.map(([name, values]) => {
      const known = creature.flatMap((sha, i): [string, number][] =>
        values[i] == null ? [] : [[sha, values[i]]],
      );
      return [name, new Map(known)];
    }),
  );
}

/** The Voronoi cells, if both axes are those of the centroids. */
function cellsOf({ axes, centroids }: Shown, names: readonly [string, string]) {
  const [x, y] = names.map((name) => axes.findIndex((axis) => axis.name === name));
  if (!centroids || axes.length !== 2 || x! < 0 || y! < 0) return null;
  return voronoiLayout(
    centroids.map((place) => [place[x!]!, 1 - place[y!]!] as const),
    Delaunay,
  );
}
