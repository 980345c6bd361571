import { describe, expect, it } from "vitest";
import { type Action, INITIAL_STATE, epochOf, reduce } from "./reducer";
import { RUN, generation, elites, snapshot, after, open, opened, creatures } from "./state.fixture";

const close: Action = { ...open, more: -1 };

describe("a snapshot", () => {
  it("keeps later events that arrived before it", () => {
    const later = reduce(reduce(opened, elites(3, 5, "cc")), elites(2, 0, "old"));
    const next = reduce(later, snapshot(later));
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
  });

  it("that comes first keeps the events since the run was opened", () => {
    const told: Action = { type: "generation", event: generation(3) };
    const waiting = after({ type: "run", run: RUN }, open, elites(3, 5, "cc"), told);
    expect(waiting.details.get("a")).toMatchObject({ archive: null, curves: null });
    const next = reduce(waiting, snapshot(waiting));
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
  });

  it("stays until the last viewer leaves, and is ignored after that", () => {
    const twice = reduce(opened, open);
    expect(creatures(twice)).toEqual(creatures(opened));
    const once = reduce(twice, close);
    expect(creatures(once)).toEqual(creatures(opened));
    const closed = reduce(once, close);
    expect(closed.details.size).toBe(0);
    expect([elites(3, 5, "cc"), snapshot(closed)].reduce(reduce, closed).details.size).toBe(0);
  });

  it("that was requested before a reset is ignored", () => {
    const late = snapshot(INITIAL_STATE);
    expect(after(open, { type: "reset" }, late).details.get("a")!.archive).toBeNull();
  });
});

describe("a rewind", () => {
  const rewind = { type: "rewind", event: { run: "a", generation: 1 } } as const;

  it("drops cells and curves of later generations", () => {
    const next = reduce(reduce(opened, elites(3, 7, "cc")), rewind);
    expect(creatures(next)).toEqual({ 0: "aa" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1]);
  });

  it("resets the figures of the run", () => {
    const back = reduce(opened, rewind);
    expect(back.runs.get("a")).toMatchObject({ generation: 1, progress: 0.1, sparkline: [1] });
    const next = reduce(back, { type: "generation", event: generation(2) });
    expect(next.runs.get("a")).toMatchObject({ generation: 2, evaluations: 32 });
  });

  it("raises the epoch of that run only", () => {
    const next = reduce(opened, rewind);
    expect(epochOf(next, "a")).toBe(epochOf(opened, "a") + 1);
    expect(epochOf(next, "b")).toBe(epochOf(opened, "b"));
  });

  it("invalidates snapshots that were requested before it", () => {
    const late = snapshot(opened);
    const next = reduce(reduce(opened, rewind), late);
    expect(creatures(next)).toEqual({ 0: "aa" });
  });
});

describe("a reset", () => {
  it("raises all epochs and keeps old data", () => {
    const next = reduce(opened, { type: "reset" });
    expect(epochOf(next, "a")).toBe(epochOf(opened, "a") + 1);
    expect(epochOf(next, "b")).toBe(epochOf(opened, "b") + 1);
    expect(creatures(next)).toEqual(creatures(opened));
  });

  it("keeps only later events after the next snapshot", () => {
    const lost = [elites(7, 9, "lost"), { type: "generation", event: generation(7) }] as Action[];
    const before = lost.reduce(reduce, opened);
    const shown = reduce(before, { type: "reset" });
    expect(creatures(shown)).toMatchObject({ 9: "lost" });
    const fresh = [elites(3, 5, "cc"), { type: "generation", event: generation(3) }] as Action[];
    const waiting = fresh.reduce(reduce, shown);
    const next = reduce(waiting, snapshot(waiting));
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
  });
});
