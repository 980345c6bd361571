import { beforeEach, describe, expect, it, vi } from "vitest";
import type { Reprojection } from "../api/types";
import { elitesByGeneration } from "../store/elites";
import { archiveOf, measuresOf } from "./archive.fixture";
import { axisOf, choicesOf, namesOf } from "./axes";
import { project } from "./projection";
import { isOver, ofQuery, setOf, setReprojectedAxes, withComponents } from "./reprojection";

const AXES = [
  { name: "pc1", low: -2, high: 2, bins: 4, scale: "linear" },
  { name: "turning", low: 0.01, high: 1, bins: 3, scale: "log10" },
] as const;

/** Cell 5 is at bin 1 of pc1 and bin 2 of turning. */
const REPROJECTION = {
  generation: 9,
  cell: [5, 0, 5],
  fitness: [1, 0.5, 2],
  descriptors: [
    [-0.5, 0.9],
    [-9, 0.01],
    [-0.2, 7],
  ],
  elite_generation: [1, 3, 4],
  emptied: [],
  emptied_generation: [],
  creature: ["slow", "odd", "fast"],
  trusted: [null, null, false],
  measures: {},
  cells: 12,
  axes: AXES,
  components: [{ name: "pc1", explained: 0.358, loadings: { turning: 0.9 } }],
} as unknown as Reprojection;

describe("a re-projection", () => {
  const archive = withComponents(archiveOf(3, "cvt"), REPROJECTION);

  it("is an archive over its own axes, whose components have titles", () => {
    expect(archive).toMatchObject({ kind: "grid", cells: 12, axes: AXES });
    const titles = new Map(choicesOf(archive));
    expect(titles.get("pc1")).toBe("Principal component 1 (35.8 % of the variance)");
    expect(titles.get("pc2")).toBe("Principal component 2");
    expect(namesOf(withComponents(archiveOf(3), null), "pc1", "turning")).toEqual(["pc1", "turning"]);
    expect(namesOf(archiveOf(3), "pc1", "turning")).toEqual(["a", "turning"]);
  });

  it("shows each creature in its cell, at any generation", () => {
    const at = elitesByGeneration(REPROJECTION);
    const shown = (generation: number) => {
      const elites = at(generation);
      const [x, y] = AXES.map(({ name }) => axisOf(name, archive, elites, measuresOf({})));
      const { layout, tiles } = project(elites, [x!, y!]);
      expect(layout.count).toBe(12);
      return [...tiles].map(([bin, { cell, elite }]) => [bin, cell, elite.creature]);
    };
    expect(shown(0)).toEqual([]);
    expect(shown(2)).toEqual([[5, 5, "slow"]]);
    expect(shown(9).sort()).toEqual([
      [0, 0, "odd"],
      [5, 5, "fast"],
    ]);
  });

  it("over other axes is not shown", () => {
    expect(isOver(REPROJECTION, ["pc1", "turning"])).toBe(true);
    expect(isOver(REPROJECTION, ["turning", "pc1"])).toBe(false);
  });
});

describe("the address", () => {
  let query: URLSearchParams;
  beforeEach(() => {
    vi.stubGlobal("window", { dispatchEvent: () => true });
    vi.stubGlobal("location", { pathname: "/runs/1", search: "?x=a&cell=3&cells=3-5&at=7" });
    vi.stubGlobal("history", {
      replaceState: (_: unknown, __: string, to: string) => (query = new URL(to, "http://here").searchParams),
    });
  });

  it("names the creatures; cells of other axes are no longer marked or selected", () => {
    setOf("history");
    expect([...query]).toEqual([
      ["x", "a"],
      ["at", "7"],
      ["of", "history"],
    ]);
    expect(ofQuery(query)).toBe("history");
    setOf("elites");
    expect(ofQuery(query)).toBe("elites");
    setReprojectedAxes({ x: "pc1", y: "pc2" });
    expect([...query.keys()]).toEqual(["x", "at", "y"]);
  });
});
