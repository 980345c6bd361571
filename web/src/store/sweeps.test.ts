import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { EMPTY, reduce } from "./reducer";

describe("what is heard of a sweep", () => {
  it("raises its news, and those of lists where it began or was steered", () => {
    const run = { id: "r", sweep: "s", spec: {}, status: "running" } as unknown as Run;
    const once = reduce(EMPTY, { type: "run", run });
    expect(once.swept.get("s")).toBe(1);
    const again = reduce(once, { type: "run", run: { ...run, generation: 2 } });
    expect([again.swept.get("s"), again.news]).toEqual([2, once.news]);
    const steered = reduce(again, { type: "sweep", sweep: "s" });
    expect([steered.swept.get("s"), steered.news]).toEqual([3, again.news + 1]);
  });
});
