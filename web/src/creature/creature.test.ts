import { describe, expect, it, test } from "vitest";
import type { Ancestors, Creature, Relative } from "../api/types";
import { familyLayoutOf } from "./FamilyCard";
import { couplingRows, groupsOf } from "./facts";
import { barsOf } from "./GenomeCard";
import { nextCell } from "./HeatMap";

describe("a heat map", () => {
  const matrix = { columns: 5, rows: 3 };

  it("is read with arrow keys, from the current time, up to its edges", () => {
    expect(nextCell("ArrowUp", null, 2, matrix)).toEqual({ column: 2, row: 0 });
    expect(nextCell("ArrowDown", null, 2, matrix)).toEqual({ column: 2, row: 2 });
    expect(nextCell("ArrowRight", null, 2, matrix)).toEqual({ column: 3, row: 0 });
    expect(nextCell("ArrowLeft", { column: 0, row: 1 }, 4, matrix)).toEqual({ column: 0, row: 1 });
    expect(nextCell("ArrowUp", { column: 4, row: 2 }, 0, matrix)).toEqual({ column: 4, row: 2 });
    expect(nextCell("Home", { column: 4, row: 2 }, 0, matrix)).toBeNull();
  });
});

describe("a family tree", () => {
  const relative = (creature: string, distance: number, parents: string[] = [], fitness = 1): Relative => ({
    creature,
    distance,
    parents,
    fitness,
    stored: true,
    operator: "neat",
    generation: 1,
    credit: [],
  });
  const me = relative("me", 0, ["a", "b"]);
  const ancestors: Ancestors = {
    parents: ["a", "b"],
    items: [relative("a", 1, ["old"]), relative("b", 1, ["old"]), relative("old", 2)],
    more: false,
  };

  it("has columns, the oldest first, and lines from parents to children", () => {
    const tree = familyLayoutOf(me, ancestors, { total: 1, items: [relative("child", 1, ["me"])] });
    expect(tree.columns.map(({ title }) => title)).toEqual([
      "Grandparents",
      "Parents",
      "This creature",
      "Children",
    ]);
    const lines = tree.lines.map(
      ([parent, child]) => `${parent.relative.creature} ${child.relative.creature}`,
    );
    expect(lines.sort()).toEqual(["a me", "b me", "me child", "old a", "old b"]);
  });

  it("draws the fittest children, and counts the others", () => {
    const items = Array.from({ length: 12 }, (_, i) => relative(`c${i}`, 1, ["me"], 11 - i));
    const tree = familyLayoutOf(me, ancestors, { total: 30, items });
    const drawn = tree.relatives.filter(({ relative }) => relative.creature.startsWith("c"));
    expect(drawn.map(({ relative }) => relative.fitness)).toEqual([11, 10, 9, 8, 7, 6, 5, 4]);
    expect(tree.hidden).toBe(22);
  });
});

describe("facts", () => {
  const creature = {
    identity: { genome: { encoding: "fold" }, world: { fluid: false, coupling: { layers: 1 } } },
    measured: { fitness: 1, descriptors: {}, measures: { displacement: 2, mach: 0.1, connections: 4 } },
  } as unknown as Creature;

  it("are in groups, each once", () => {
    const groups = groupsOf(creature);
    expect(groups.map(({ title }) => title)).toEqual(["Result", "Network", "Flow"]);
    expect(groups.flatMap(({ rows }) => rows).map(([name]) => name)).toEqual([
      "Fitness",
      "Displacement",
      "Connections",
      "Largest Mach number",
    ]);
  });

  it("do not mention the coupling without a fluid", () => {
    expect(couplingRows(creature)).toEqual([]);
  });
});

test("a strip of genes has a bar for each, or for the largest of several where there are very many", () => {
  expect(barsOf(Float32Array.from([0.5, -1]))).toEqual([0.5, -1]);
  const many = Float32Array.from({ length: 4000 }, (_, i) => (i === 13 ? -1 : 0.25));
  const bars = barsOf(many);
  expect([bars.length, bars[1], bars[0]]).toEqual([400, -1, 0.25]);
});
