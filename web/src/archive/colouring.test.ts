import { describe, expect, it } from "vitest";
import { colourMeasure, colouringOf, binColours, placeOf, valueAlong } from "./colouring";
import { rasterOf, gridLayout } from "./layout";
import { archiveOf, elite, NONE, over } from "./archive.fixture";

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
    const measures = new Map([
      [
        "turning",
        new Map([
          ["c1", 0.5],
          ["c10", 0.7],
        ]),
      ],
    ]);
    const measure = colourMeasure("turning", archiveOf(2), measures, 5);
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
