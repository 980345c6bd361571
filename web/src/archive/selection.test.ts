import { describe, expect, it } from "vitest";
import type { Principal } from "../api/types";
import type { Elite } from "../store/elites";
import { refusalOf } from "../store/principal";
import { parseCells, formatCells } from "../store/draft";
import { elite } from "./archive.fixture";
import { binsOf, binsWithin, cellsIn, regionOf, selectByKey, toggle } from "./selection";
import { gridLayout } from "./layout";
import { forkedCells } from "./SelectionBar";
import type { Projection } from "./projection";

const set = (...cells: number[]) => new Set(cells);

describe("cells in an address", () => {
  it.each<[number[], string]>([
    [[], ""],
    [[7], "7"],
    [[3, 4, 5, 9], "3-5,9"],
    [[9, 4, 3, 10, 5], "3-5,9-10"],
  ])("%o are %s", (cells, text) => {
    expect(formatCells(cells)).toBe(text);
    expect([...Array(20).keys()].filter(parseCells(text))).toEqual([...cells].sort((a, b) => a - b));
  });

  it.each(["x", "-3", "3-", "1.5", "5-3"])("%s is ignored", (text) => {
    expect([...Array(20).keys()].filter(parseCells(text))).toEqual([]);
  });
});

const mapOf = <T>(entries: Record<number, T>) =>
  new Map(Object.entries(entries).map(([key, value]) => [Number(key), value]));

/** A map of 4 × 4 bins with two elites in bin 5. */
const layout = gridLayout([4, 4]);
const tile = (cell: number, hidden = 0) => ({ cell, elite: elite(1), hidden });
const projection: Projection = {
  layout,
  tiles: mapOf({ 0: tile(100), 5: tile(101, 1), 15: tile(103) }),
  bins: mapOf({ 100: 0, 101: 5, 102: 5, 103: 15 }),
  elites: new Map(),
};

describe("a box on the map", () => {
  const within = (from: [number, number], to: [number, number]) =>
    binsWithin(regionOf([from, to]), layout, projection.tiles);

  it("selects the filled bins whose middle it contains, drawn either way", () => {
    expect(within([0, 0.5], [0.5, 0.99])).toEqual([0, 5]);
    expect(within([0.5, 0.99], [0, 0.5])).toEqual([0, 5]);
    expect(within([0.5, 0.5], [0.9, 0.9])).toEqual([]);
  });

  it("selects the bins under its corners", () => {
    expect(within([0.24, 0.8], [0.26, 0.74])).toEqual([0, 5]);
  });

  it("selects all elites in its bins", () => {
    expect(cellsIn([0, 5], projection)).toEqual(set(100, 101, 102));
    expect(binsOf(set(102, 7), projection)).toEqual(set(5));
    expect(binsOf(set(), projection)).toBeNull();
  });
});

describe("a way around cells", () => {
  const within = (...way: [number, number][]) => binsWithin(regionOf(way), layout, projection.tiles);

  it("selects what it encloses, not what its box would contain", () => {
    const around: [number, number][] = [[0.02, 0.98], [0.02, 0.55], [0.55, 0.55], [0.3, 0.7], [0.2, 0.98]]; // prettier-ignore
    expect(within(...around)).toEqual([0, 5]);
    expect(within([0.02, 0.98], [0.02, 0.02], [0.98, 0.02])).toEqual([0, 15]);
  });

  it("is a box if it is nearly straight", () => {
    expect(regionOf([[0, 0], [0.24, 0.26], [0.5, 0.5]])).toEqual([[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]]); // prettier-ignore
    expect(regionOf([[0, 0], [0.5, 0.1], [0.5, 0.5]])).toHaveLength(3); // prettier-ignore
    expect(regionOf([[0, 0], [0.5, 0.5], [0.3, 0.3], [0.1, 0.1]])).toHaveLength(4); // prettier-ignore
  });
});

describe("a key on the map", () => {
  const press = (key: string, selected: Set<number>, next: number | null = null, shiftKey = false) =>
    selectByKey({ key, shiftKey } as KeyboardEvent, selected, projection, 5, next);

  it("toggles a bin with Space", () => {
    expect(press(" ", set(100))).toEqual(set(100, 101, 102));
    expect(press(" ", set(100, 101))).toEqual(set(100, 101, 102));
    expect(press(" ", set(100, 101, 102))).toEqual(set(100));
    expect(toggle(set(), set(3))).toEqual(set(3));
  });

  it("extends the selection with Shift and an arrow, and clears it with Escape", () => {
    expect(press("ArrowRight", set(), 15, true)).toEqual(set(101, 102, 103));
    expect(press("ArrowRight", set(), 15)).toBeNull();
    expect(press("Escape", set(100))).toEqual(set());
    expect(press("Escape", set())).toBeNull();
  });
});

describe("a token", () => {
  const principal = (scope: Principal["scope"]): Principal => ({
    name: "ada",
    scope,
    token: "t",
    expires_at: null,
    needed: true,
  });

  it.each<[Principal["scope"], owner: string | null | undefined, RegExp | null]>([
    ["read", undefined, /read-only/],
    ["read", "ada", /read-only/],
    ["write", undefined, null],
    ["write", "ada", null],
    ["write", "bob", /^Only bob or an admin/],
    ["write", null, /^Only an admin/],
    ["admin", "bob", null],
  ])("of scope %s and a resource of %s", (scope, owner, refusal) => {
    const refused = refusalOf(principal(scope), owner === undefined ? undefined : { owner });
    if (refusal) expect(refused).toMatch(refusal);
    else expect(refused).toBeNull();
  });

  it("is not refused before it is loaded", () => {
    expect(refusalOf(null, { owner: "bob" })).toBeNull();
  });
});

describe("a fork", () => {
  const shown = new Map([3, 4, 9].map((cell) => [cell, {} as Elite]));

  it("takes the selected cells, else those that are shown", () => {
    expect(forkedCells(set(4), shown, "trusted")).toBe("4");
    expect(forkedCells(set(), shown, "trusted")).toBe("3-4,9");
    expect(forkedCells(set(), shown, "")).toBeNull();
  });
});
