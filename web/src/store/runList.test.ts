import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Generations, Run, RunQuery } from "../api/types";

const RUNS = Array.from({ length: 500 }, (_, i) => ({ id: String(i) }) as Run);

vi.mock("../api/client", () => ({
  readRuns: async ({ cursor, limit }: RunQuery) => {
    if (limit! > 200) throw new Error(`at most 200, got ${limit}`);
    const [from, to] = [Number(cursor ?? 0), Number(cursor ?? 0) + limit!];
    return { items: RUNS.slice(from, to), next: to < RUNS.length ? String(to) : null };
  },
}));

const { readUpTo } = await import("./runList");
const { RETAIN_MS, currentState, retain, update } = await import("./store");
const { withSnapshot } = await import("./state");

describe("a list that is read again", () => {
  it.each([
    [0, 30],
    [90, 90],
    [200, 200],
    [330, 330],
    [500, 500],
    [700, 500],
  ])("with %i runs known has %i of them, each once and in order", async (known, expected) => {
    const { items, next } = await readUpTo({ sort: "name" }, known);
    expect(items).toEqual(RUNS.slice(0, expected));
    expect(next).toBe(expected < 500 ? String(expected) : null);
  });
});

describe("the details of runs", () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());
  const generations = {
    generation: [1],
    evaluations: [1],
    seconds: [1],
    qd_score: [1],
    coverage: [1],
    best: [1],
    summary: {},
  } as unknown as Generations;
  const retained = () => [...currentState().details.keys()];

  it("stay for runs that are still shown", () => {
    const leave = retain(["a", "b"]);
    update((state) => withSnapshot(state, "a", 0, null, generations));
    leave();
    const end = retain(["a"]);
    expect(currentState().details.get("a")!.curves!.generation).toEqual([1]);
    vi.advanceTimersByTime(RETAIN_MS);
    expect(retained()).toEqual(["a"]);
    expect(currentState().details.get("a")!.curves!.generation).toEqual([1]);
    end();
    vi.advanceTimersByTime(RETAIN_MS);
    expect(retained()).toEqual([]);
  });

  it("stay for a minute after the page was left", () => {
    const leave = retain(["a"]);
    leave();
    vi.advanceTimersByTime(RETAIN_MS - 1);
    expect(currentState().details.size).toBe(1);
    vi.advanceTimersByTime(1);
    expect(currentState().details.size).toBe(0);
  });
});
