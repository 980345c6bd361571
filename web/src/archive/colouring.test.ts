import { describe, expect, it } from "vitest";
import { colourMeasure, colouringOf, binColours, colourPosition } from "./colouring";
import { valueAt } from "../charts/plot/scale";
import { rasterOf, gridLayout } from "./layout";
import { archiveOf, elite, elitesOf, measuresOf, NONE, over } from "./archive.fixture";

describe("the colours of a map", () => {
  const elites = elitesOf({ 0: elite(1, 0.1, 1), 1: elite(10, 0.9, 1), 2: elite(100, 0.5, 1) });
  const { tiles } = over(archiveOf(2), elites, ["a", "b"]);

  it("go from the lowest to the highest value, on a log scale by decades", () => {
    const measure = { ...colourMeasure("fitness", archiveOf(2), NONE, 5), scale: "log10" as const };
    const colouring = colouringOf(measure, "viridis", tiles);
    expect(colouring.scale).toEqual({ log: true, low: 1, high: 100 });
    expect(valueAt(colouring.scale, 0.5)).toBeCloseTo(10);
    expect([...tiles.values()].map((tile) => colourPosition(colouring, tile))).toEqual([0, 0.5, 1]);
  });

  it("clip the values of past elites", () => {
    const fitness = colourMeasure("fitness", archiveOf(2), NONE, 5);
    const colouring = colouringOf(fitness, "viridis", tiles);
    const past = over(archiveOf(2), new Map([[0, elite(-7, 0.1, 1)]]), ["a", "b"]).tiles;
    expect(binColours(past, 4, colouring, 7, 8)[0]).toBe(binColours(tiles, 4, colouring, 7, 8)[0]);
  });

  it("by age count back from the generation shown", () => {
    const measure = colourMeasure("age", archiveOf(2), NONE, 9);
    expect(measure.valueOf(elite(1, 0))).toBe(8);
  });

  it("distinguish an unknown value from an empty cell and from known ones", () => {
    const measures = measuresOf({ turning: { c1: 0.5, c10: 0.7 } });
    const measure = colourMeasure("turning", archiveOf(2), measures, 5);
    const colours = binColours(tiles, 4, colouringOf(measure, "viridis", tiles), 7, 8);
    expect(colours[2]).toBe(8);
    expect(colours[3]).toBe(7);
    expect(colours[0]).not.toBe(colours[1]);
  });
});

describe("the pixels of a map", () => {
  it("show the bins, the last row of a grid at the top", () => {
    expect([...rasterOf(gridLayout([2, 2]), 2, 2, 1)]).toEqual([1, 3, 0, 2]);
  });

  it("leave gaps between roomy bins, and none between narrow ones", () => {
    const roomy = rasterOf(gridLayout([2, 1]), 20, 10, 1);
    expect(roomy[10]).toBe(-1);
    expect([roomy[0], roomy[9], roomy[11]]).toEqual([0, 0, 1]);
    expect(rasterOf(gridLayout([10, 1]), 20, 10, 1)).not.toContain(-1);
  });
});
