import { describe, expect, it } from "vitest";
import { NONE } from "../decode/phylogeny";
import { press } from "./gestures";
import { landmarksOf, ranked } from "./landmarks";
import { chainsOf, layoutOf, surviving } from "./layout";
import { lineOf, nearest, otherParents, relativeAt } from "./nearest";
import { shadesOf } from "./shades";
import { strokesOf } from "./strokes";
import { SvgContext } from "./svg";
import { grownTree, treeOf } from "./tree.fixture";
import { clamped, extentOf, moved, placeOf, scalesOf, whole, zoomFor, zoomOf, zoomed } from "./view";

const SIZE = { width: 1000, height: 600 };
const tree = grownTree(20_000);
const layout = layoutOf(tree);
const extent = extentOf(tree, layout);
const start = clamped(whole(extent), extent, SIZE);
const pointOf = (i: number) => ({ time: tree.time[i]!, row: layout.row[i]! });

describe("a view", () => {
  it("of the whole tree has every creature in the window", () => {
    const scales = scalesOf(extent, SIZE, 0);
    const outside = [...layout.row.keys()].filter((i) => {
      const [x, y] = placeOf(pointOf(i), scales, start, SIZE);
      return x < 0 || x > SIZE.width || y < 0 || y > SIZE.height;
    });
    expect(outside).toEqual([]);
  });

  it("keeps what is under the pointer when it is enlarged", () => {
    const [creature, log] = [12_345, 1.5];
    const place = placeOf(pointOf(creature), scalesOf(extent, SIZE, 0), start, SIZE);
    const near = zoomed(start, zoomFor(log, extent, SIZE), place, extent, SIZE);
    const scales = scalesOf(extent, SIZE, near.zoom);
    const after = placeOf(pointOf(creature), scales, near, SIZE);
    expect(after[0]).toBeCloseTo(place[0], 6);
    expect(after[1]).toBeCloseTo(place[1], 6);
    expect(scales.y / scalesOf(extent, SIZE, 0).y).toBeCloseTo(Math.exp(log), 6);
  });

  it("follows the pointer and does not leave the tree", () => {
    const near = clamped({ ...start, zoom: 0.8 }, extent, SIZE);
    const { y } = scalesOf(extent, SIZE, 0.8);
    expect(moved(near, [0, 30], extent, SIZE).row).toBeCloseTo(near.row - 30 / y, 6);
    const far = moved(near, [0, 1e9], extent, SIZE);
    expect(placeOf({ time: 0, row: 0 }, scalesOf(extent, SIZE, 0.8), far, SIZE)[1]).toBeLessThan(60);
  });

  it("finds the zoom of a height", () => {
    expect(scalesOf(extent, SIZE, zoomOf(26, extent, SIZE)).y).toBeCloseTo(26, 6);
    expect(scalesOf(extent, SIZE, 1).y).toBeCloseTo(64, 6);
  });
});

describe("a tree of which nothing is shown", () => {
  it("has a finite view, from which the whole tree comes back", () => {
    const lost = { ...tree, lost: new Int32Array(tree.count).fill(1) };
    const nothing = layoutOf(tree, surviving(lost, layout.parent));
    expect(nothing.totalRows).toBe(0);
    const empty = extentOf(tree, nothing);
    const close = clamped({ ...start, zoom: 0.5 }, extent, SIZE);
    for (const view of [clamped(close, empty, SIZE), clamped(whole(empty), empty, SIZE)]) {
      expect(Object.values(view).every(Number.isFinite)).toBe(true);
      const back = clamped(view, extent, SIZE);
      expect(Object.values(back).every(Number.isFinite)).toBe(true);
    }
    expect(nearest(tree, nothing, [500, 300], start, scalesOf(empty, SIZE, 0), SIZE, Infinity)).toBe(NONE);
  });
});

describe("strokes", () => {
  const { shade, colours } = shadesOf(tree, "fitness", "dark");
  const scene = { tree, layout, chains: chainsOf(layout), size: SIZE, shade, shades: colours.length };
  const at = (zoom: number, view = start) => ({
    ...scene,
    view: clamped({ ...view, zoom }, extent, SIZE),
    scales: scalesOf(extent, SIZE, zoom),
  });
  const lines = (found: ReturnType<typeof strokesOf>) =>
    found.lines.reduce((sum, line) => sum + line.length / 4, 0);

  it("of a whole tree are fewer than its creatures", () => {
    const found = strokesOf({ ...at(0), at: Infinity, whole: true });
    expect(lines(found)).toBeGreaterThan(500);
    expect(lines(found)).toBeLessThan(tree.count / 2);
    expect(found.dots).toEqual([]);
  });

  it("show each creature in the window once with its dot", () => {
    const near = at(1);
    const found = strokesOf({ ...near, at: Infinity, whole: true });
    const inside = [...layout.row.keys()].filter((i) => {
      const [x, y] = placeOf(pointOf(i), near.scales, near.view, SIZE);
      return x > 0 && x < SIZE.width && y > 0 && y < SIZE.height;
    });
    const dots = new Set(found.dots.filter((_, k) => k % 3 === 2));
    expect(inside.length).toBeGreaterThan(3);
    expect(inside.filter((i) => !dots.has(i))).toEqual([]);
    expect(dots.size).toBe(found.dots.length / 3);
  });

  it("show nothing that is later than the slider", () => {
    const found = strokesOf({ ...at(0.5), at: 40, whole: true });
    const { x } = scalesOf(extent, SIZE, 0.5);
    const right = SIZE.width / 2 + (40 - at(0.5).view.time) * x;
    for (const line of found.lines) {
      for (let k = 2; k < line.length; k += 4) expect(line[k]).toBeLessThanOrEqual(right + 1e-6);
    }
    expect(lines(strokesOf({ ...at(0.5), at: 0, whole: true }))).toBe(0);
  });

  it("tell how many creatures a collapsed line stands for", () => {
    const line = treeOf([[1], [2, 0], [3, 1], [4, 2], [5, 0]]);
    const rows = layoutOf(line);
    const small = extentOf(line, rows);
    const view = clamped({ zoom: 1, time: 3, row: 0.5 }, small, SIZE);
    const scales = scalesOf(small, SIZE, 1);
    const drawn = { ...scene, tree: line, layout: rows, chains: chainsOf(rows), view, scales, at: 9 };
    expect(strokesOf({ ...drawn, whole: false }).counts[2]).toBe(2);
    expect(strokesOf({ ...drawn, whole: false }).dots.length / 3).toBe(3);
    expect(strokesOf({ ...drawn, whole: true }).dots.length / 3).toBe(5);
  });
});

describe("the creature at a point", () => {
  it("is the one that stands there", () => {
    const view = clamped({ ...start, zoom: 1 }, extent, SIZE);
    const scales = scalesOf(extent, SIZE, 1);
    const inside = [...layout.row.keys()].filter((i) => {
      const [x, y] = placeOf(pointOf(i), scales, view, SIZE);
      return x > 0 && x < SIZE.width && y > 0 && y < SIZE.height;
    });
    for (const i of inside) {
      const place = placeOf(pointOf(i), scales, view, SIZE);
      expect(nearest(tree, layout, place, view, scales, SIZE, Infinity)).toBe(i);
    }
    expect(nearest(tree, layout, [-500, 0], start, scalesOf(extent, SIZE, 0), SIZE, Infinity)).toBe(NONE);
  });
});

describe("keys", () => {
  const family = treeOf([[1], [2, 0], [2, 0], [3, 1], [3, 1, 2], [9]]);
  const rows = layoutOf(family);

  it("lead to the parent, along the line, and to the neighbours", () => {
    expect(relativeAt(rows, family, 4, "ArrowLeft")).toBe(1);
    expect(relativeAt(rows, family, 0, "ArrowLeft")).toBe(0);
    const child = relativeAt(rows, family, 0, "ArrowRight");
    expect(rows.row[child]).toBe(rows.row[0]);
    expect(relativeAt(rows, family, 3, "ArrowRight")).toBe(3);
    const below = relativeAt(rows, family, rows.byRow[0]!, "ArrowDown");
    expect(rows.row[below]).toBe(1);
    expect(relativeAt(rows, family, rows.byRow[0]!, "ArrowUp")).toBe(rows.byRow[0]);
  });

  it("begin with the fittest and open what is selected", () => {
    const log: unknown[] = [];
    const note = (what: string) => (value: unknown) => void log.push([what, value]);
    const stage = { zoom: note("zoom"), all: () => note("all")(0), pan: note("pan"), reveal: note("reveal") };
    const loaded = { tree: family, layout: rows, chains: chainsOf(rows) };
    const selection = { select: note("select"), open: note("open") };
    const key = (key: string, selected: number, shiftKey = false) =>
      press({ key, shiftKey }, loaded, stage, { selected, ...selection });
    expect(key("ArrowUp", NONE)).toBe(true);
    expect(key("Enter", 3)).toBe(true);
    expect(key("ArrowUp", 3, true)).toBe(true);
    expect(key("0", 3)).toBe(true);
    expect(key("a", 3)).toBe(false);
    expect(key("Enter", NONE)).toBe(false);
    expect(log).toEqual([
      ["select", 5],
      ["reveal", 5],
      ["open", 3],
      ["pan", [0, 80]],
      ["all", 0],
    ]);
  });

  it("know the line of descent and its second parents", () => {
    expect(lineOf(rows, 4)).toEqual([4, 1, 0]);
    expect(otherParents(family, rows, [4, 1, 0])).toEqual([[4, 2]]);
  });
});

describe("landmarks", () => {
  it("do not overlap, and begin with the focus", () => {
    const ranking = ranked(tree, layout, () => 0);
    for (const zoom of [0, 0.5, 1]) {
      const view = clamped({ ...start, zoom }, extent, SIZE);
      const scales = scalesOf(extent, SIZE, zoom);
      const focus = nearest(tree, layout, [500, 300], view, scales, SIZE, Infinity);
      const found = landmarksOf(
        ranking,
        tree,
        layout,
        view,
        scales,
        SIZE,
        Infinity,
        focus < 0 ? [] : [focus],
      );
      const places = found.map(({ creature }) => placeOf(pointOf(creature), scales, view, SIZE));
      expect(found.length).toBeGreaterThan(3);
      if (focus >= 0) expect(found[0]!.creature).toBe(focus);
      places.forEach(([x, y], a) =>
        places.slice(a + 1).forEach(([x2, y2]) => {
          expect(Math.hypot(x2 - x, y2 - y)).toBeGreaterThanOrEqual(found[a]!.side);
        }),
      );
    }
  });
});

describe("a path of SVG", () => {
  it("has what is traced on it", () => {
    const path = new SvgContext();
    path.moveTo(1.26, 2);
    path.lineTo(3, -4);
    path.bezierCurveTo(1, 2, 3, 4, 5, 6);
    path.closePath();
    expect(path.d).toBe("M1.3 2L3 -4C1 2 3 4 5 6z");
  });

  it("is drawn with the styles of a canvas", () => {
    const context = new SvgContext();
    Object.assign(context, { strokeStyle: "#123", lineWidth: 2, globalAlpha: 0.5 });
    context.moveTo(0, 0);
    context.setLineDash([3, 4]);
    context.stroke();
    expect(context.tags).toEqual([
      '<path d="M0 0" fill="none" stroke="#123" stroke-width="2" stroke-dasharray="3 4" opacity="0.5"/>',
    ]);
  });
});
