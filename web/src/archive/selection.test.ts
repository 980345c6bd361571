/** Elites chosen on a map: by box and by key, written into an address; and what a token may not. */

import { describe, expect, it } from "vitest";
import type { Principal } from "../api/types";
import { refusalOf } from "../store/principal";
import { parseCells, formatCells } from "../store/cellRanges";
import { binsOf, binsWithin, cellsIn, selectByKey, toggle } from "./selection";
import { gridLayout } from "./layout";
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

  it.each(["x", "-3", "3-", "1.5", "5-3"])("%s is none", (text) => {
    expect([...Array(20).keys()].filter(parseCells(text))).toEqual([]);
  });
});

/** A map of 4 by 4 bins: bin i * 4 + j is i to the right and j upwards; in bin 5 stand two. */
const layout = gridLayout([4, 4]);
const elite = { fitness: 1, descriptors: [], generation: 1, creature: "c", seenAt: 1 };
const tile = (cell: number, behind = 0) => ({ cell, elite, behind });
const projection: Projection = {
  layout,
  tiles: new Map([
    [0, tile(100)],
    [5, tile(101, 1)],
    [15, tile(103)],
  ]),
  bins: new Map([
    [100, 0],
    [101, 5],
    [102, 5],
    [103, 15],
  ]),
};

describe("a box on the map", () => {
  const within = (from: [number, number], to: [number, number]) =>
    binsWithin({ from, to }, layout, projection.tiles);

  it("has the filled bins whose middle it has, drawn either way", () => {
    expect(within([0, 0.5], [0.5, 0.99])).toEqual([0, 5]);
    expect(within([0.5, 0.99], [0, 0.5])).toEqual([0, 5]);
    expect(within([0.5, 0.5], [0.9, 0.9])).toEqual([]);
  });

  it("has the bins that it begins and ends in", () => {
    expect(within([0.24, 0.8], [0.26, 0.74])).toEqual([0, 5]);
  });

  it("is of all elites that stand in its bins", () => {
    expect(cellsIn([0, 5], projection)).toEqual(set(100, 101, 102));
    expect(binsOf(set(102, 7), projection)).toEqual(set(5));
    expect(binsOf(set(), projection)).toBeNull();
  });
});

describe("a key on the map", () => {
  const press = (key: string, chosen: Set<number>, next: number | null = null, shiftKey = false) =>
    selectByKey({ key, shiftKey } as KeyboardEvent, chosen, projection, 5, next);

  it("turns a bin by Space", () => {
    expect(press(" ", set(100))).toEqual(set(100, 101, 102));
    expect(press(" ", set(100, 101))).toEqual(set(100, 101, 102));
    expect(press(" ", set(100, 101, 102))).toEqual(set(100));
    expect(toggle(set(), set(3))).toEqual(set(3));
  });

  it("adds along the way by Shift with an arrow, and lets go by Escape", () => {
    expect(press("ArrowRight", set(), 15, true)).toEqual(set(101, 102, 103));
    expect(press("ArrowRight", set(), 15)).toBeNull();
    expect(press("Escape", set(100))).toEqual(set());
    expect(press("Escape", set())).toBeNull();
  });
});

describe("a token", () => {
  const caller = (scope: Principal["scope"]): Principal => ({
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
  ])("of scope %s with what %s made", (scope, owner, refusal) => {
    const said = refusalOf(caller(scope), owner === undefined ? undefined : { owner });
    if (refusal) expect(said).toMatch(refusal);
    else expect(said).toBeNull();
  });

  it("is not judged before it is known", () => {
    expect(refusalOf(null, { owner: "bob" })).toBeNull();
  });
});
