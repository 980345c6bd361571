import { describe, expect, it } from "vitest";
import { INITIAL_STATE, epochOf, reset } from "./state";
import {
  RUN,
  after,
  close,
  creatures,
  elites,
  emptied,
  generation,
  open,
  opened,
  rewind,
  run,
  snapshot,
  snapshotSince,
} from "./state.fixture";

describe("a snapshot", () => {
  it("keeps later events that arrived before it", () => {
    const next = after(opened, elites(3, 5, "cc"), elites(2, 0, "old"), snapshot);
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
  });

  it("that comes first keeps the events since the run was opened", () => {
    const waiting = after(INITIAL_STATE, run(RUN), open, elites(3, 5, "cc"), generation(3));
    expect(waiting.details.get("a")).toMatchObject({ archive: null, curves: null });
    const next = snapshot(waiting);
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
  });

  it("stays until the last viewer leaves, and is ignored after that", () => {
    const twice = open(opened);
    expect(creatures(twice)).toEqual(creatures(opened));
    const once = close(twice);
    expect(creatures(once)).toEqual(creatures(opened));
    const closed = close(once);
    expect(closed.details.size).toBe(0);
    expect(after(closed, elites(3, 5, "cc"), snapshot).details.size).toBe(0);
  });

  it("that was requested before a reset is ignored", () => {
    const next = after(INITIAL_STATE, open, reset, snapshotSince(INITIAL_STATE));
    expect(next.details.get("a")!.archive).toBeNull();
  });
});

describe("a cell that loses its elite", () => {
  it("is empty until it has a new one", () => {
    expect(creatures(after(opened, emptied(3, 0)))).toEqual({ 5: "bb" });
    expect(creatures(after(opened, emptied(3, 0), elites(4, 0, "cc")))).toEqual({ 0: "cc", 5: "bb" });
  });

  it("stays empty after an older snapshot, not after a newer one", () => {
    expect(creatures(after(opened, emptied(3, 5), snapshot))).toEqual({ 0: "aa" });
    expect(creatures(after(opened, emptied(2, 5), snapshot))).toEqual({ 0: "aa", 5: "bb" });
  });

  it("has its elite again in the snapshot after a rewind", () => {
    const next = after(opened, emptied(3, 5), rewind(2));
    expect(creatures(next)).toEqual({ 0: "aa" });
    expect(creatures(snapshot(next))).toEqual({ 0: "aa", 5: "bb" });
  });
});

describe("a rewind", () => {
  it("drops cells and curves of later generations", () => {
    const next = after(opened, elites(3, 7, "cc"), rewind(1));
    expect(creatures(next)).toEqual({ 0: "aa" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1]);
  });

  it("resets the figures of the run", () => {
    const back = after(opened, rewind(1));
    expect(back.runs.get("a")).toMatchObject({ generation: 1, progress: 0.1, sparkline: [1] });
    const next = after(back, generation(2));
    expect(next.runs.get("a")).toMatchObject({ generation: 2, evaluations: 32 });
  });

  it("raises the epoch of that run only", () => {
    const next = after(opened, rewind(1));
    expect(epochOf(next, "a")).toBe(epochOf(opened, "a") + 1);
    expect(epochOf(next, "b")).toBe(epochOf(opened, "b"));
  });

  it("invalidates snapshots that were requested before it", () => {
    expect(creatures(after(opened, rewind(1), snapshotSince(opened)))).toEqual({ 0: "aa" });
  });
});

describe("a reset", () => {
  it("raises all epochs and keeps old data", () => {
    const next = reset(opened);
    expect(epochOf(next, "a")).toBe(epochOf(opened, "a") + 1);
    expect(epochOf(next, "b")).toBe(epochOf(opened, "b") + 1);
    expect(creatures(next)).toEqual(creatures(opened));
  });

  it("keeps only later events after the next snapshot", () => {
    const shown = after(opened, elites(7, 9, "lost"), generation(7), reset);
    expect(creatures(shown)).toMatchObject({ 9: "lost" });
    const next = after(shown, elites(3, 5, "cc"), generation(3), snapshot);
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
  });
});
