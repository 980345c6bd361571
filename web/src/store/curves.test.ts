import { describe, expect, it } from "vitest";
import type { Values } from "../api/types";
import { INITIAL_STATE, type State, reset, withResultsEvent } from "./state";
import { MAX_POINTS, appendCurves, withPoint } from "./curves";
import {
  RUN,
  after,
  close,
  generation,
  generationEvent,
  open,
  opened,
  rewind,
  run,
  snapshotSince,
} from "./state.fixture";

const bareSince = (before: State) => snapshotSince(before, null);
const bare = (state: State) => bareSince(state)(state);
const results = (generation: number, summary: Values | null) => (state: State) =>
  withResultsEvent(state, { run: "a", generation, rows: [], summary });

describe("long runs", () => {
  it("are thinned out", () => {
    const full = Array.from({ length: MAX_POINTS }, (_, i) => i);
    const rare = full.map((i) => (i === 7 || i === MAX_POINTS - 1 ? i : null));
    const costs = { evaluations: full, seconds: full };
    const columns = { generation: full, ...costs, qd_score: full, coverage: full, best: full };
    const next = appendCurves({ ...columns, summary: { rare } }, generationEvent(MAX_POINTS));
    expect(next.generation.length).toBe(MAX_POINTS / 2 + 1);
    expect(next.generation.at(-1)).toBe(MAX_POINTS);
    const values = next.summary.rare!.flatMap((value, i) => (value === null ? [] : [[i, value]]));
    expect(values).toEqual([
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
    const detail = after(INITIAL_STATE, open, bare).details.get("a")!;
    expect([detail.archive, detail.elites.size]).toEqual([null, 0]);
    expect(detail.curves!.generation).toEqual([1, 2]);
  });

  it("counts the changes of its table", () => {
    const state = after(INITIAL_STATE, results(3, null), results(3, null));
    expect([state.tableVersions.get("a"), state.tableVersions.get("b")]).toEqual([2, undefined]);
  });

  it("keeps its newest summary", () => {
    const state = after(
      INITIAL_STATE,
      run(RUN),
      results(2, { best: 2 }),
      results(3, null),
      results(1, { best: 1 }),
    );
    expect(state.runs.get("a")!.summary).toEqual({ best: 2 });
  });
});

describe("curves without an archive", () => {
  const shown = (state: State) => state.details.get("a")?.curves;

  it("grow with every generation, before or after the snapshot", () => {
    expect(shown(after(INITIAL_STATE, open, generation(3), bare))!.generation).toEqual([1, 2, 3]);
    const later = shown(after(INITIAL_STATE, open, bare, generation(3)))!;
    expect([later.evaluations, later.seconds]).toEqual([
      [16, 32, 48],
      [1, 2, 6],
    ]);
  });

  it("are truncated by a rewind, after which older snapshots are ignored", () => {
    const state = after(INITIAL_STATE, open, bare, generation(3), rewind(1));
    expect(shown(state)!.generation).toEqual([1]);
    expect(shown(after(state, bareSince(INITIAL_STATE)))!.generation).toEqual([1]);
    expect(shown(bare(state))!.generation).toEqual([1, 2]);
  });

  it("outlive a reset until the next snapshot", () => {
    const state = after(INITIAL_STATE, open, bare, generation(3), reset);
    expect(shown(state)!.generation).toEqual([1, 2, 3]);
    expect(shown(bare(state))!.generation).toEqual([1, 2]);
  });

  it("are dropped with the last viewer", () => {
    expect(after(INITIAL_STATE, open, open, bare, close).details.size).toBe(1);
    expect(after(INITIAL_STATE, open, open, bare, close, close).details.size).toBe(0);
    expect(after(INITIAL_STATE, bare, generation(3)).details.size).toBe(0);
  });

  it("leave the archive of another snapshot in place", () => {
    const detail = bare(opened).details.get("a")!;
    expect(detail.archive).not.toBeNull();
    expect(detail.elites.size).toBe(2);
  });
});
