/** Re-projection: all creatures that ever entered an archive, over the axes of the map. */

import { useMemo } from "preact/hooks";
import type { Archive, Reprojection, Run } from "../api/types";
import { type Elites, type Measures, elitesByGeneration } from "../store/elites";
import { useReprojection } from "../store/fetch";
import { setQuery } from "../store/router";
import { percent } from "../ui/format";
import { missingOf } from "./axes";
import { AGE } from "./colouring";
import { text } from "./text";

/** The creatures of a map. */
export type Of = "elites" | "history";

export const ofQuery = (query: URLSearchParams): Of => (query.get("of") === "history" ? "history" : "elites");

/** Cells over other axes are others, so marks and selections end. */
const NO_CELLS = { cell: null, cells: null };

export const setOf = (of: Of) => setQuery({ of: of === "history" ? of : null, ...NO_CELLS });

export const setReprojectedAxes = (axes: Record<string, string>) => setQuery({ ...axes, ...NO_CELLS });

/** Principal components that can be axes. */
const COMPONENTS = ["pc1", "pc2", "pc3"] as const;

/** The archive with components among its measures, over a grid. */
export function withComponents(archive: Archive, reprojection: Reprojection | null): Archive {
  const explained = new Map(reprojection?.components.map((one) => [one.name, one.explained]));
  const components = COMPONENTS.map((name) => {
    const share = explained.get(name);
    const title = text.component(name.slice(2), share === undefined ? null : percent(share));
    return { name, title, unit: "", low: null, high: null, scale: "linear" as const, bins: null };
  });
  // Learned axes are known for elites alone.
  const recorded = [...archive.recorded.filter(({ bins }) => !bins), ...components];
  const { axes, cells } = reprojection ?? archive;
  return { ...archive, kind: "grid", axes, cells, recorded };
}

export interface Reprojected {
  archive: Archive;
  reprojection: Reprojection | null;
  newest: Elites;
  elitesAt: ((generation: number) => Elites) | null;
  measures: Measures;
  error: string | null;
}

const NOTHING: Elites = new Map();
const NO_MEASURES: Measures = new Map();

/** The re-projection of a run; its archive is empty until it is loaded. Null without axes. */
export function useReprojected(
  run: Run,
  archive: Archive,
  axes: [string, string] | null,
  colour: string,
): Reprojected | null {
  const names = axes ? missingOf({ ...archive, axes: [] }, [colour]).filter((name) => name !== AGE) : [];
  const { value, error } = useReprojection(run, axes, names);
  // The last answer may be about other axes.
  const current = value && axes && isOver(value.reprojection, axes) ? value : null;
  const isShown = axes !== null;
  return useMemo(() => {
    if (!isShown) return null;
    const { reprojection = null, measures = NO_MEASURES } = current ?? {};
    return {
      archive: withComponents(archive, reprojection),
      reprojection,
      newest: reprojection ? elitesByGeneration(reprojection)(reprojection.generation) : NOTHING,
      elitesAt: reprojection && elitesByGeneration(reprojection),
      measures,
      error,
    };
  }, [archive, current, isShown, error]);
}

export const isOver = ({ axes }: Reprojection, names: readonly string[]) =>
  names.join() === axes.map(({ name }) => name).join();
