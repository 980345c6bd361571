import { describe, expect, it } from "vitest";
import type { Values } from "../api/types";
import { type Action, INITIAL_STATE, type State, reduce } from "./reducer";
import { MAX_POINTS, appendCurves, withPoint } from "./curves";
import { RUN, generation, snapshot, after, open, opened } from "./state.fixture";

const bare = (state: State): Action => ({ ...(snapshot(state) as object), archive: null }) as Action;

describe("long runs", () => {
  it("are thinned out", () => {
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
  it("has curves and no elites", () => {
    const detail = after(open, bare).details.get("a")!;
    expect([detail.archive, detail.elites.size]).toEqual([null, 0]);
    expect(detail.curves!.generation).toEqual([1, 2]);
  });

  it("counts the changes of its table", () => {
    const event = { run: "a", generation: 3, rows: [], summary: null };
    const state = after({ type: "results", event }, { type: "results", event });
    expect([state.tableVersions.get("a"), state.tableVersions.get("b")]).toEqual([2, undefined]);
  });

  it("keeps its newest summary", () => {
    const told = (generation: number, summary: Values | null): Action => {
      return { type: "results", event: { run: "a", generation, rows: [], summary } };
    };
    const run: Action = { type: "run", run: RUN };
    const state = after(run, told(2, { best: 2 }), told(3, null), told(1, { best: 1 }));
    expect(state.runs.get("a")!.summary).toEqual({ best: 2 });
  });
});

describe("curves without an archive", () => {
  const close: Action = { ...open, more: -1 };
  const third: Action = { type: "generation", event: generation(3) };
  const shown = (state: State) => state.details.get("a")?.curves;

  it("grow with every generation, before or after the snapshot", () => {
    expect(shown(after(open, third, bare))!.generation).toEqual([1, 2, 3]);
    const later = shown(after(open, bare, third))!;
    expect([later.evaluations, later.seconds]).toEqual([
      [16, 32, 48],
      [1, 2, 6],
    ]);
  });

  it("are truncated by a rewind, after which older snapshots are ignored", () => {
    const back: Action = { type: "rewind", event: { run: "a", generation: 1 } };
    const state = after(open, bare, third, back);
    expect(shown(state)!.generation).toEqual([1]);
    expect(shown(reduce(state, bare(INITIAL_STATE)))!.generation).toEqual([1]);
    expect(shown(reduce(state, bare(state)))!.generation).toEqual([1, 2]);
  });

  it("outlive a reset until the next snapshot", () => {
    const state = after(open, bare, third, { type: "reset" });
    expect(shown(state)!.generation).toEqual([1, 2, 3]);
    expect(shown(reduce(state, bare(state)))!.generation).toEqual([1, 2]);
  });

  it("are dropped with the last viewer", () => {
    expect(after(open, open, bare, close).details.size).toBe(1);
    expect(after(open, open, bare, close, close).details.size).toBe(0);
    expect(after(bare, third).details.size).toBe(0);
  });

  it("leave the archive of another snapshot in place", () => {
    const detail = reduce(opened, bare(opened)).details.get("a")!;
    expect(detail.archive).not.toBeNull();
    expect(detail.elites.size).toBe(2);
  });
});
