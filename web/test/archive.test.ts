import { describe, expect, it } from "vitest";
import type { Archive, Run } from "../src/api/types";
import type { Elite, Elites } from "../src/live/elites";
import type { Curves } from "../src/live/curves";
import { axisOf, choicesOf, missingOf, namesOf } from "../src/view/archive/axes";
import { binOf, project } from "../src/view/archive/projection";
import { scoresOf, workOf } from "../src/view/curves/plots";
import { endingOf } from "../src/view/ending";
import { colourMeasure, colouringOf, binColours, placeOf, valueAlong } from "../src/view/archive/colouring";
import { rasterOf, gridLayout, voronoiLayout } from "../src/view/archive/layout";
import { cornerOf, visibleBins } from "../src/view/gallery/wall";
import { walkThrough } from "../src/live/history";
import { Delaunay } from "d3-delaunay";
import { barsOf } from "../src/view/network/GeneStrip";

const AXES = [
  { name: "a", low: 0, high: 1, bins: 2, scale: "linear" },
  { name: "b", low: 1, high: 100, bins: 4, scale: "log10" },
  { name: "c", low: 0, high: 1, bins: 3, scale: "linear" },
] as const;

const recorded = ["a", "b", "c", "turning", "nodes"].map((name) => {
  return { name, title: name.toUpperCase(), unit: "rad", low: 0.01, high: 1, scale: "linear" };
});

function archiveOf(count: number, kind: Archive["kind"] = "grid"): Archive {
  return { kind, axes: AXES.slice(0, count), recorded } as unknown as Archive;
}

function elite(fitness: number, ...descriptors: number[]): Elite {
  return { fitness, descriptors, generation: 1, creature: `c${fitness}`, told: 1 };
}

const NONE = new Map();
const over = (archive: Archive, elites: Elites, names: [string, string], features = NONE) =>
  project(elites, [axisOf(names[0], archive, elites, features), axisOf(names[1], archive, elites, features)]);

describe("the axes of a map", () => {
  it("are the archive's first two, and fitness where there is but one", () => {
    expect(namesOf(archiveOf(3), null, null)).toEqual(["a", "b"]);
    expect(namesOf(archiveOf(1), null, null)).toEqual(["a", "fitness"]);
    expect(namesOf(archiveOf(2), "turning", "c")).toEqual(["turning", "c"]);
    expect(namesOf(archiveOf(2), "b", null)).toEqual(["b", "a"]);
    expect(namesOf(archiveOf(2), "unheard of", "fitness")).toEqual(["a", "fitness"]);
  });

  it("can be everything that was recorded, of which elites carry their descriptors", () => {
    expect(choicesOf(archiveOf(2)).at(-1)).toEqual(["fitness", "Fitness"]);
    expect(missingOf(archiveOf(2), ["a", "turning"])).toEqual(["turning"]);
    expect(missingOf(archiveOf(2), ["b", "fitness"])).toEqual([]);
  });

  it("have round ends around values, whole bins for whole numbers, decades on a log scale", () => {
    const elites = new Map([
      [0, elite(0.31, 0)],
      [1, elite(1.18, 0)],
    ]);
    const fitness = axisOf("fitness", archiveOf(1), elites, NONE);
    expect(fitness.low).toBeLessThanOrEqual(0.31);
    expect(fitness.high).toBeGreaterThanOrEqual(1.18);
    expect(fitness.high - fitness.low).toBeLessThan(1.3);
    const nodes = new Map([
      [
        "nodes",
        new Map([
          ["c0.31", 3],
          ["c1.18", 9],
        ]),
      ],
    ]);
    expect(axisOf("nodes", archiveOf(1), elites, nodes)).toMatchObject({ low: 3, high: 10, bins: 7 });
    const log = archiveOf(1);
    log.recorded[3]!.scale = "log10";
    const turning = new Map([
      [
        "turning",
        new Map([
          ["c0.31", 0.02],
          ["c1.18", 30],
        ]),
      ],
    ]);
    const axis = axisOf("turning", log, elites, turning);
    log.recorded[3]!.scale = "linear";
    expect([axis.low, axis.high]).toEqual([0.01, 100]);
    expect(axisOf("turning", archiveOf(1), elites, NONE)).toMatchObject({ low: 0.01, high: 1 });
  });
});

describe("an archive on a map", () => {
  it("of its own two axes has each cell at its place, whatever its descriptors round to", () => {
    const elites = new Map(Array.from({ length: 8 }, (_, cell) => [cell, elite(cell, 9, 9)]));
    const { layout, tiles, bins } = over(archiveOf(2), elites, ["a", "b"]);
    expect(layout.count).toBe(8);
    expect([...tiles].map(([bin, { cell }]) => [bin, cell])).toEqual([...bins].map(([c, b]) => [b, c]));
    expect([...bins]).toEqual(Array.from({ length: 8 }, (_, cell) => [cell, cell]));
  });

  it("of three axes shows the best of those that fall together, and counts the others", () => {
    // Cells of a 2 × 4 × 3 grid: 12 k + 3 j + i.
    const elites = new Map([
      [3, elite(1, 0, 2, 0)],
      [4, elite(5, 0, 2, 0.5)],
      [5, elite(2, 0, 2, 1)],
      [20, elite(3, 1, 9, 1)],
    ]);
    const { tiles, bins } = over(archiveOf(3), elites, ["a", "b"]);
    expect([...tiles.keys()]).toEqual([1, 6]);
    expect(tiles.get(1)).toMatchObject({ cell: 4, behind: 2 });
    expect(tiles.get(6)).toMatchObject({ cell: 20, behind: 0 });
    expect([3, 4, 5, 20].map((cell) => bins.get(cell))).toEqual([1, 1, 1, 6]);
    const turned = over(archiveOf(3), elites, ["c", "a"]);
    expect([turned.layout.count, turned.bins.get(20)]).toEqual([6, 5]);
  });

  it("of Voronoi cells is binned by what was measured, until they are known", () => {
    const elites = new Map([[777, elite(1, 0.99, 1)]]);
    const { layout, bins } = over(archiveOf(2, "cvt"), elites, ["a", "b"]);
    expect(layout.centre(bins.get(777)!)).toEqual([47 / 48, 47 / 48]);
  });

  it("of Voronoi cells shows each cell around its centroid", () => {
    const cells = voronoiLayout(
      [
        [0.2, 0.2],
        [0.8, 0.2],
        [0.5, 0.9],
      ],
      Delaunay,
    );
    const elites = new Map([[2, elite(1, 0.99, 1)]]);
    const axis = (name: string) => axisOf(name, archiveOf(2, "cvt"), elites, NONE);
    const { tiles, layout } = project(elites, [axis("a"), axis("b")], [], cells);
    expect([...tiles.keys()]).toEqual([2]);
    expect([layout.at(0.1, 0.1), layout.at(0.9, 0.1), layout.at(0.5, 0.99)]).toEqual([0, 1, 2]);
    expect(layout.at(1, 0.5)).toBeNull();
    for (const [x, y] of layout.outline(0)) expect(x <= 0.5 && y <= 1).toBe(true);
  });

  it("shows what passes the slices of the axes that it folds", () => {
    const elites = new Map([
      [3, elite(1, 0, 2, 0)],
      [4, elite(5, 0, 2, 0.5)],
      [5, elite(2, 0, 2, 1)],
    ]);
    const axis = (name: string) => axisOf(name, archiveOf(3), elites, NONE);
    const through = (from: number, to: number) =>
      project(elites, [axis("a"), axis("b")], [{ axis: axis("c"), from, to }]).tiles.get(1);
    expect(through(0, 2)).toMatchObject({ cell: 4, behind: 2 });
    expect(through(2, 2)).toMatchObject({ cell: 5, behind: 0 });
    expect(through(0, 0)).toMatchObject({ cell: 3, behind: 0 });
  });

  it("along a feature leaves out whom it is not known of", () => {
    const elites = new Map([
      [0, elite(1, 0, 1)],
      [1, elite(2, 0, 1)],
    ]);
    const features = new Map([["turning", new Map([["c2", 0.5]])]]);
    const { tiles } = over(archiveOf(2), elites, ["turning", "fitness"], features);
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
    expect(binOf(AXES[1], value)).toBe(bin);
  });
});

describe("curves", () => {
  const figures = { qd_score: [1], coverage: [0.5], best: [2] };
  const bare = { generation: [1], evaluations: [16], seconds: [2], ...figures, summary: {} };

  it("have what was told beside them, and nothing where nothing was", () => {
    expect(scoresOf(bare).map(({ series }) => series.length)).toEqual([1, 1, 1]);
    expect(workOf(bare)).toEqual([]);
    const told: Curves = {
      ...bare,
      summary: {
        corrected_qd_score: [0.8],
        "neat: inserted": [3],
        "iso+line: inserted": [4],
        "neat: improved": [0],
        device_seconds: [0.1],
      },
    };
    expect(scoresOf(told)[0]!.series[1]).toMatchObject({ y: [0.8], dots: true });
    expect(workOf(told).map(({ title, series }) => [title, ...series.map(({ name }) => name)])).toEqual([
      ["Into empty cells", "neat", "iso+line"],
      ["Better than before", "neat"],
      ["Device-seconds", "device_seconds"],
    ]);
  });
});

describe("why a run ended", () => {
  const run = { generations: 50, spec: { search: { stop: { evaluations: 5000 } } } } as unknown as Run;
  it.each([
    [null, "It ended with the last of its 50 generations."],
    [
      "evaluations after generation 12",
      "It ended after generation 12: its budget of 5,000 evaluations was used up.",
    ],
    ["device_hours after generation 3", "It ended early: device hours after generation 3."],
  ])("%j is told as %j", (ended, sentence) => {
    expect(endingOf({ ...run, summary: ended ? { ended } : null })).toBe(sentence);
  });
});

describe("a strip of genes", () => {
  it("has a bar for each, or for the farthest of several where there are very many", () => {
    expect(barsOf(Float32Array.from([0.5, -1]))).toEqual([0.5, -1]);
    const many = Float32Array.from({ length: 4000 }, (_, i) => (i === 13 ? -1 : 0.25));
    const bars = barsOf(many);
    expect([bars.length, bars[1], bars[0]]).toEqual([400, -1, 0.25]);
  });
});

describe("the colours of a map", () => {
  const elites = new Map([
    [0, elite(1, 0.1, 1)],
    [1, elite(10, 0.9, 1)],
    [2, elite(100, 0.5, 1)],
  ]);
  const { tiles } = over(archiveOf(2), elites, ["a", "b"]);

  it("go from the least to the greatest value, on a log scale by decades", () => {
    const measure = { ...colourMeasure("fitness", archiveOf(2), NONE, 5), scale: "log10" as const };
    const colouring = colouringOf(measure, "viridis", tiles);
    expect(colouring.range).toEqual([0, 2]);
    expect(valueAlong(colouring, 0.5)).toBeCloseTo(10);
    expect([...tiles.values()].map((tile) => placeOf(colouring, tile))).toEqual([0, 0.5, 1]);
  });

  it("have a place for those of the past, who may be less fit than anybody is now", () => {
    const fitness = colourMeasure("fitness", archiveOf(2), NONE, 5);
    const colouring = colouringOf(fitness, "viridis", tiles);
    const past = over(archiveOf(2), new Map([[0, elite(-7, 0.1, 1)]]), ["a", "b"]).tiles;
    expect(binColours(past, 4, colouring, 7, 8)[0]).toBe(binColours(tiles, 4, colouring, 7, 8)[0]);
  });

  it("by age count back from the generation that is shown", () => {
    const measure = colourMeasure("age", archiveOf(2), NONE, 9);
    expect(measure.valueOf(elite(1, 0))).toBe(8);
  });

  it("tell an unknown value from an empty cell and from any known one", () => {
    const features = new Map([
      [
        "turning",
        new Map([
          ["c1", 0.5],
          ["c10", 0.7],
        ]),
      ],
    ]);
    const measure = colourMeasure("turning", archiveOf(2), features, 5);
    const colours = binColours(tiles, 4, colouringOf(measure, "viridis", tiles), 7, 8);
    expect(colours[2]).toBe(8);
    expect(colours[3]).toBe(7);
    expect(colours[0]).not.toBe(colours[1]);
  });
});

describe("the pixels of a map", () => {
  it("know the bins under them, the last row of a grid at the top", () => {
    expect([...rasterOf(gridLayout([2, 2]), 2, 2, 1)]).toEqual([1, 3, 0, 2]);
  });

  it("leave gaps between roomy bins, and none between narrow ones", () => {
    const roomy = rasterOf(gridLayout([2, 1]), 20, 10, 1);
    expect(roomy[10]).toBe(-1);
    expect([roomy[0], roomy[9], roomy[11]]).toEqual([0, 0, 1]);
    expect(rasterOf(gridLayout([10, 1]), 20, 10, 1)).not.toContain(-1);
  });
});

describe("the past of an archive", () => {
  const columns = { cell: [1, 2, 1], fitness: [1, 2, 3], descriptors: [[0], [0], [0]] };
  const history = {
    ...columns,
    generation: 4,
    elite_generation: [1, 1, 4],
    creature: ["a", "b", "c"],
    features: {},
  };

  it.each([
    [0, []],
    [1, ["a", "b"]],
    [3, ["a", "b"]],
    [4, ["c", "b"]],
  ])("after generation %s has the last elite of each cell", (generation, creatures) => {
    const then = walkThrough(history)(generation);
    expect([...then.values()].map(({ creature }) => creature)).toEqual(creatures);
  });

  it("is the same whichever way one came to it", () => {
    const walk = walkThrough(history);
    const seen = [4, 1, 0, 3, 4].map((generation) =>
      [...walk(generation).values()].map(({ creature }) => creature).join(""),
    );
    expect(seen).toEqual(["cb", "ab", "", "ab", "cb"]);
  });
});

describe("a wall of creatures", () => {
  it("has the first axis to the right, the second upwards", () => {
    expect(cornerOf(0, [3, 2], 10)).toEqual([0, 10]);
    expect(cornerOf(5, [3, 2], 10)).toEqual([20, 0]);
  });

  it("shows the filled tiles in the window, those in its middle first", () => {
    const window = { left: 15, top: 0, width: 15, height: 10 };
    expect(visibleBins([0, 1, 2, 3, 4, 5], [3, 2], 10, window)).toEqual([5, 3]);
    expect(visibleBins([0, 1], [3, 2], 10, window)).toEqual([]);
  });
});
