import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { axisOf, choicesOf, containerOf, missingOf, namesOf, objectiveOf } from "./axes";
import { binOfValue, elitesIn, project, tileWith } from "./projection";
import { containerText } from "./text";
import { type Position, voronoiLayout } from "./layout";
import { Delaunay } from "d3-delaunay";
import { withComponents } from "./reprojection";
import { AXES, archiveOf, elite, elitesOf, measuresOf, NONE, over } from "./archive.fixture";

describe("the axes of a map", () => {
  it("are the archive's first two, or its only one and fitness", () => {
    expect(namesOf(archiveOf(3), null, null)).toEqual(["a", "b"]);
    expect(namesOf(archiveOf(1), null, null)).toEqual(["a", "fitness"]);
    expect(namesOf(archiveOf(2), "turning", "c")).toEqual(["turning", "c"]);
    expect(namesOf(archiveOf(2), "b", null)).toEqual(["b", "a"]);
    expect(namesOf(archiveOf(2), "unheard of", "fitness")).toEqual(["a", "fitness"]);
  });

  it("are learned axes where there are any, with their own ends and bins", () => {
    const archive = archiveOf(2, "pool");
    const learned = { ...archive.recorded[0]!, name: "learned_1", low: -3, high: 2, bins: 5 };
    archive.recorded = [learned, ...archive.recorded];
    expect(namesOf(archive, null, null)).toEqual(["learned_1", "a"]);
    const found = axisOf("learned_1", archive, new Map(), NONE);
    expect(found).toMatchObject({ low: -3, high: 2, bins: 5, binOfCell: null });
    expect(withComponents(archive, null).recorded.map(({ name }) => name)).not.toContain("learned_1");
  });

  it("can be any measure; descriptors need not be fetched", () => {
    expect(choicesOf(archiveOf(2)).at(-1)).toEqual(["fitness", "Fitness"]);
    expect(missingOf(archiveOf(2), ["a", "turning"])).toEqual(["turning"]);
    expect(missingOf(archiveOf(2), ["b", "fitness"])).toEqual([]);
  });

  it("have round ends, whole bins for integers, and decades on a log scale", () => {
    const elites = elitesOf({ 0: elite(0.31, 0), 1: elite(1.18, 0) });
    const fitness = axisOf("fitness", archiveOf(1), elites, NONE);
    expect(fitness.low).toBeLessThanOrEqual(0.31);
    expect(fitness.high).toBeGreaterThanOrEqual(1.18);
    expect(fitness.high - fitness.low).toBeLessThan(1.3);
    const nodes = measuresOf({ nodes: { "c0.31": 3, "c1.18": 9 } });
    expect(axisOf("nodes", archiveOf(1), elites, nodes)).toMatchObject({ low: 3, high: 10, bins: 7 });
    const log = archiveOf(1);
    log.recorded[3]!.scale = "log10";
    const turning = measuresOf({ turning: { "c0.31": 0.02, "c1.18": 30 } });
    const axis = axisOf("turning", log, elites, turning);
    log.recorded[3]!.scale = "linear";
    expect([axis.low, axis.high]).toEqual([0.01, 100]);
    expect(axisOf("turning", archiveOf(1), elites, NONE)).toMatchObject({ low: 0.01, high: 1 });
  });
});

describe("an archive on a map", () => {
  /** Elites in the same column of a 2 × 4 × 3 grid, whose cells are 12 i + 3 j + k. */
  const together = { 3: elite(1, 0, 2, 0), 4: elite(5, 0, 2, 0.5), 5: elite(2, 0, 2, 1) };

  it("over its own axes shows each cell at its place, whatever its descriptors are", () => {
    const elites = new Map(Array.from({ length: 8 }, (_, cell) => [cell, elite(cell, 9, 9)]));
    const { layout, tiles, bins } = over(archiveOf(2), elites, ["a", "b"]);
    expect(layout.count).toBe(8);
    expect([...tiles].map(([bin, { cell }]) => [bin, cell])).toEqual([...bins].map(([c, b]) => [b, c]));
    expect([...bins]).toEqual(Array.from({ length: 8 }, (_, cell) => [cell, cell]));
  });

  it("of three axes shows the best elite of a bin, and counts the others", () => {
    const elites = elitesOf({ ...together, 20: elite(3, 1, 9, 1) });
    const { tiles, bins } = over(archiveOf(3), elites, ["a", "b"]);
    expect([...tiles.keys()]).toEqual([1, 6]);
    expect(tiles.get(1)).toMatchObject({ cell: 4, hidden: 2 });
    expect(tiles.get(6)).toMatchObject({ cell: 20, hidden: 0 });
    expect([3, 4, 5, 20].map((cell) => bins.get(cell))).toEqual([1, 1, 1, 6]);
    const turned = over(archiveOf(3), elites, ["c", "a"]);
    expect([turned.layout.count, turned.bins.get(20)]).toEqual([6, 5]);
  });

  it("of Voronoi cells is binned by descriptors until the centroids are known", () => {
    const elites = new Map([[777, elite(1, 0.99, 1)]]);
    const { layout, bins } = over(archiveOf(2, "cvt"), elites, ["a", "b"]);
    expect(layout.centre(bins.get(777)!)).toEqual([47 / 48, 47 / 48]);
  });

  it("of Voronoi cells shows each cell around its centroid", () => {
    const points = ["0.2 0.2", "0.8 0.2", "0.5 0.9"].map((point) => point.split(" ").map(Number));
    const cells = voronoiLayout(points as unknown as Position[], Delaunay);
    const elites = new Map([[2, elite(1, 0.99, 1)]]);
    const axis = (name: string) => axisOf(name, archiveOf(2, "cvt"), elites, NONE);
    const { tiles, layout } = project(elites, [axis("a"), axis("b")], [], cells);
    expect([...tiles.keys()]).toEqual([2]);
    expect([layout.at(0.1, 0.1), layout.at(0.9, 0.1), layout.at(0.5, 0.99)]).toEqual([0, 1, 2]);
    expect(layout.at(1, 0.5)).toBeNull();
    for (const [x, y] of layout.outline(0)) expect(x <= 0.5 && y <= 1).toBe(true);
  });

  it("shows the elites within the slices of hidden axes", () => {
    const elites = elitesOf(together);
    const axis = (name: string) => axisOf(name, archiveOf(3), elites, NONE);
    const through = (from: number, to: number) =>
      project(elites, [axis("a"), axis("b")], [{ axis: axis("c"), from, to }]).tiles.get(1);
    expect(through(0, 2)).toMatchObject({ cell: 4, hidden: 2 });
    expect(through(2, 2)).toMatchObject({ cell: 5, hidden: 0 });
    expect(through(0, 0)).toMatchObject({ cell: 3, hidden: 0 });
  });

  it("along a measure omits elites without a value", () => {
    const elites = elitesOf({ 0: elite(1, 0, 1), 1: elite(2, 0, 1) });
    const measures = measuresOf({ turning: { c2: 0.5 } });
    const { tiles } = over(archiveOf(2), elites, ["turning", "fitness"], measures);
    expect([...tiles.values()].map(({ cell }) => cell)).toEqual([1]);
  });

  it.each([
    [0.5, 0],
    [1, 0],
    [3.17, 1],
    [99, 3],
    [100, 3],
    [1e9, 3],
  ])("puts %s into bin %s of a log axis from 1 to 100", (value, bin) => {
    expect(binOfValue(AXES[1], value)).toBe(bin);
  });
});

describe("a pool", () => {
  /** Places whose numbers say nothing: three elites in one bin, one in another. */
  const elites = elitesOf({
    7: elite(1, 0.2, 2),
    0: elite(3, 0.3, 2),
    900: elite(2, 0.1, 2),
    5: elite(4, 0.9, 50),
  });
  const pool = over(archiveOf(2, "pool"), elites, ["a", "b"]);

  it("shows elites where their descriptors are, in the bins of the spec", () => {
    expect(pool.layout.count).toBe(8);
    expect(Object.fromEntries(pool.bins)).toEqual({ 7: 0, 0: 0, 900: 0, 5: 7 });
    expect(pool.tiles.get(0)).toMatchObject({ cell: 0, hidden: 2 });
    expect(pool.tiles.get(7)).toMatchObject({ cell: 5, hidden: 0 });
  });

  it("lists the elites of a bin, the best first", () => {
    expect(elitesIn(pool, 0).map(([cell, { fitness }]) => [cell, fitness])).toEqual([
      [0, 3],
      [900, 2],
      [7, 1],
    ]);
  });

  it("shows the marked elite of a bin instead of its best", () => {
    expect(tileWith(pool, 0, 900)).toMatchObject({ cell: 900, elite: { fitness: 2 }, hidden: 2 });
    expect(tileWith(pool, 0, 5)).toMatchObject({ cell: 0 });
    expect(tileWith(pool, 0, null)).toMatchObject({ cell: 0 });
    expect(tileWith(pool, 3, 900)).toBeUndefined();
  });

  it("is named by the container of the spec", () => {
    const run = { spec: { archive: { container: { kind: "fronts", measure: "nodes" } } } } as unknown as Run;
    expect(objectiveOf(run, archiveOf(2, "pool"))).toBe("nodes");
    expect(containerText(containerOf(run)!.kind)).toBe("Pareto fronts");
    expect(containerOf({ spec: { archive: {} } } as unknown as Run)).toBeNull();
    const cells = { spec: {} } as unknown as Run;
    expect([containerOf(cells), objectiveOf(cells, archiveOf(2))]).toEqual([null, "fitness"]);
  });
});
