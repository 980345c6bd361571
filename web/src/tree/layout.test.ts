import { describe, expect, it } from "vitest";
import { NONE } from "../decode/phylogeny";
import { type TreeLayout, chainsOf, layoutOf, surviving } from "./layout";
import { grownTree, treeOf } from "./tree.fixture";

/** 0 has the children 1 and 2; 1 has 3 and 4; 2 has 5, whose only child is 6; 7 is alone. */
const SMALL = treeOf([[1], [2, 0], [2, 0], [3, 1], [4, 1], [3, 2], [6, 5], [5]]);

/** Of every two creatures with the same time and row. */
function overlaps({ row }: TreeLayout, time: Int32Array): number {
  const places = Array.from(row, (row, i) => `${time[i]} ${row}`).filter((_, i) => row[i] !== NONE);
  return places.length - new Set(places).size;
}

describe("rows of a tree", () => {
  const layout = layoutOf(SMALL);

  it("are as many as childless creatures, and a trunk is straight", () => {
    expect(layout.totalRows).toBe(4);
    const { row } = layout;
    expect(row[0]).toBe(row[1]); // The child with the most lines of descent.
    expect([row[2], row[2]]).toEqual([row[5], row[6]]);
    expect(new Set([row[3], row[4], row[6], row[7]])).toEqual(new Set([0, 1, 2, 3]));
  });

  it("count descendants and know the latest of them", () => {
    expect([...layout.size]).toEqual([7, 3, 3, 1, 1, 2, 1, 1]);
    expect([...layout.last]).toEqual([6, 4, 6, 3, 4, 6, 6, 5]);
    expect([...layout.children]).toEqual([2, 2, 1, 0, 0, 1, 0, 0]);
  });

  it("list creatures before their descendants, which end before the next", () => {
    const { order, end, parent } = layout;
    const place = new Map([...order].map((i, p) => [i, p]));
    expect(place.size).toBe(8);
    for (const [i, p] of place) {
      const above = parent[i]!;
      if (above === NONE) continue;
      expect(p).toBeGreaterThan(place.get(above)!);
      expect(p).toBeLessThan(end[place.get(above)!]!);
    }
  });

  it("are the first parent's where there are two", () => {
    const crossed = layoutOf(treeOf([[1], [1], [2, 1, 0]]));
    expect([...crossed.parent]).toEqual([NONE, NONE, 1]);
  });

  it("hold trees without or with one creature", () => {
    expect(layoutOf(treeOf([])).totalRows).toBe(0);
    expect([...layoutOf(treeOf([[1]])).row]).toEqual([0]);
  });
});

describe("100,000 births", () => {
  const tree = grownTree(100_000);
  const layout = layoutOf(tree);

  it("never overlap in a generation", () => {
    expect(overlaps(layout, tree.time)).toBe(0);
    expect(layout.row.every((row) => row >= 0 && row < layout.totalRows)).toBe(true);
  });

  it("have subtrees that share no row", () => {
    const { order, end, low, rows, row, parent } = layout;
    const wrong = [...order.keys()].filter((p) => {
      const i = order[p]!;
      const next = order[end[p]!];
      const outside = row[i]! < low[i]! || row[i]! >= low[i]! + rows[i]!;
      const kin = next !== undefined && parent[next] === parent[i];
      return outside || (kin && low[next] !== low[i]! + rows[i]!);
    });
    expect(wrong).toEqual([]);
  });

  it("stand by row and time", () => {
    const { byRow, start, row, totalRows } = layout;
    expect(start[totalRows]).toBe(tree.count);
    const wrong = [...byRow.keys()].slice(1).filter((k) => {
      const [before, now] = [byRow[k - 1]!, byRow[k]!];
      if (start[row[now]!]! > k) return true;
      return row[before] === row[now] ? tree.time[before]! >= tree.time[now]! : row[before]! + 1 !== row[now];
    });
    expect(wrong).toEqual([]);
  });

  it("keep their number when single lines collapse", () => {
    const { within, above, between } = chainsOf(layout);
    const kept = [...within.keys()].filter((i) => !within[i]);
    expect(kept.reduce((sum, i) => sum + 1 + between[i]!, 0)).toBe(tree.count);
    expect(kept.length).toBeLessThan(0.9 * tree.count);
    expect(kept.filter((i) => above[i] !== NONE && within[above[i]!])).toEqual([]);
  });
});

describe("a collapsed line", () => {
  it("stands for the creatures between a fork and the next", () => {
    const { within, above, between } = chainsOf(layoutOf(SMALL));
    expect([...within]).toEqual([0, 0, 1, 0, 0, 1, 0, 0]);
    expect([above[6], between[6]]).toEqual([0, 2]);
    expect([above[1], between[1]]).toEqual([0, 0]);
  });
});

describe("the lines of the elites now", () => {
  it("have elites that were lost only where a line leads on", () => {
    const lost = Int32Array.from([2, 3, 9, 9, NONE, 9, 9, NONE]);
    const tree = { ...SMALL, lost };
    const kept = surviving(tree, layoutOf(tree).parent);
    expect([...kept]).toEqual([1, 1, 0, 0, 1, 0, 0, 1]);
    const pruned = layoutOf(tree, kept);
    expect(pruned.totalRows).toBe(2);
    expect([...pruned.row].map((row) => row === NONE)).toEqual([...kept].map((one) => !one));
    expect([...pruned.order].sort()).toEqual([0, 1, 4, 7]);
  });
});
