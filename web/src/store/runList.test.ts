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

const { readUpTo: readAsFar } = await import("./runList");
const { currentState: current, dispatch } = await import("./store");
const { RETAIN_MS: KEPT_MS, retain: look } = await import("./retain");

describe("a list that is asked for again", () => {
  it.each([
    [0, 30],
    [90, 90],
    [200, 200],
    [330, 330],
    [500, 500],
    [700, 500],
  ])("with %i runs known has %i of them, each once and in order", async (known, expected) => {
    const { items, next } = await readAsFar({ sort: "name" }, known);
    expect(items).toEqual(RUNS.slice(0, expected));
    expect(next).toBe(expected < 500 ? String(expected) : null);
  });
});

describe("looking at runs", () => {
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
  const watched = () => [...current().watching.keys()];

  it("keeps the curves of those that are still looked at when one is left out", () => {
    const leave = look("watch", ["a", "b"]);
    dispatch({ type: "curves", run: "a", epoch: 0, generations });
    leave();
    const end = look("watch", ["a"]);
    expect(current().watching.get("a")!.curves!.generation).toEqual([1]);
    vi.advanceTimersByTime(KEPT_MS);
    expect(watched()).toEqual(["a"]);
    expect(current().watching.get("a")!.curves!.generation).toEqual([1]);
    end();
    vi.advanceTimersByTime(KEPT_MS);
    expect(watched()).toEqual([]);
  });

  it("keeps a run's page for the way back, and not for ever", () => {
    const leave = look("open", ["a"]);
    leave();
    vi.advanceTimersByTime(KEPT_MS - 1);
    expect(current().details.size).toBe(1);
    vi.advanceTimersByTime(1);
    expect(current().details.size).toBe(0);
  });
});
