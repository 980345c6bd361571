import { describe, expect, it } from "vitest";
import type { Values } from "../api/types";
import { type Action, INITIAL_STATE, type State, epochOf, reduce } from "./reducer";
import { MAX_POINTS, appendCurves } from "./curves";
import { withPoint } from "./sparkline";
import { RUN, GENERATIONS, generation, snapshot, after, open } from "./state.fixture";

describe("long runs", () => {
  it("are thinned out instead of growing for ever", () => {
    const full = Array.from({ length: MAX_POINTS }, (_, i) => i);
    const rare = full.map((i) => (i === 7 || i === MAX_POINTS - 1 ? i : null));
    const costs = { evaluations: full, seconds: full };
    const columns = { generation: full, ...costs, qd_score: full, coverage: full, best: full };
    const next = appendCurves({ ...columns, summary: { rare } }, generation(MAX_POINTS));
    expect(next.generation.length).toBe(MAX_POINTS / 2 + 1);
    expect(next.generation.at(-1)).toBe(MAX_POINTS);
    const told = next.summary.rare!.flatMap((value, i) => (value === null ? [] : [[i, value]]));
    expect(told).toEqual([
      [4, 7],
      [MAX_POINTS / 2, MAX_POINTS - 1],
    ]);
    expect(next.summary.inserted!.length).toBe(MAX_POINTS / 2 + 1);
  });

  it("keep a straight sparkline straight", () => {
    let line: number[] = [];
    for (let g = 1; g <= 200; g++) line = withPoint(line, g - 1, 3 * g, g);
    expect(line.length).toBe(32);
    line.forEach((value, k) => expect(value).toBeCloseTo(3 + (k * 597) / 31, 6));
  });
});

describe("a run without an archive", () => {
  const bare = (state: State): Action => ({ ...(snapshot(state) as object), archive: null }) as Action;

  it("has curves and no elites", () => {
    const detail = after(open, bare).details.get("a")!;
    expect([detail.archive, detail.elites.size]).toEqual([null, 0]);
    expect(detail.curves!.generation).toEqual([1, 2]);
  });

  it("is told of each growth of its table, and others are not", () => {
    const event = { run: "a", generation: 3, rows: [], summary: null };
    const state = after({ type: "results", event }, { type: "results", event });
    expect([state.tableVersions.get("a"), state.tableVersions.get("b")]).toEqual([2, undefined]);
  });

  it("has the newest summary that was told, and keeps it where none comes", () => {
    const told = (generation: number, summary: Values | null): Action => {
      return { type: "results", event: { run: "a", generation, rows: [], summary } };
    };
    const run: Action = { type: "run", run: RUN };
    const state = after(run, told(2, { best: 2 }), told(3, null), told(1, { best: 1 }));
    expect(state.runs.get("a")!.summary).toEqual({ best: 2 });
  });
});

describe("curves of runs that are looked at beside others", () => {
  const watch = (more: 1 | -1): Action => ({ type: "watch", run: "a", more });
  const curves = (state: State): Action => ({
    type: "curves",
    run: "a",
    epoch: epochOf(state, "a"),
    generations: GENERATIONS,
  });
  const third: Action = { type: "generation", event: generation(3) };
  const told = (state: State) => state.watching.get("a")?.curves;

  it("grow with every generation, told before or after the snapshot", () => {
    expect(told(after(watch(1), third, curves))!.generation).toEqual([1, 2, 3]);
    const later = told(after(watch(1), curves, third))!;
    expect([later.evaluations, later.seconds]).toEqual([
      [16, 32, 48],
      [1, 2, 6],
    ]);
  });

  it("are cut by a rewind, and no snapshot from before it counts", () => {
    const back: Action = { type: "rewind", event: { run: "a", generation: 1 } };
    const state = after(watch(1), curves, third, back);
    expect(told(state)!.generation).toEqual([1]);
    expect(told(reduce(state, curves(INITIAL_STATE)))!.generation).toEqual([1]);
    expect(told(reduce(state, curves(state)))!.generation).toEqual([1, 2]);
  });

  it("outlive a reset, but not the next snapshot", () => {
    const state = after(watch(1), curves, third, { type: "reset" });
    expect(told(state)!.generation).toEqual([1, 2, 3]);
    expect(told(reduce(state, curves(state)))!.generation).toEqual([1, 2]);
  });

  it("are forgotten when the last one has looked away", () => {
    expect(after(watch(1), watch(1), curves, watch(-1)).watching.size).toBe(1);
    expect(after(watch(1), watch(1), curves, watch(-1), watch(-1)).watching.size).toBe(0);
    expect(after(curves, third).watching.size).toBe(0);
  });
});
