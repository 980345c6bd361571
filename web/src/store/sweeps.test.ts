import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { INITIAL_STATE, reduce } from "./reducer";

describe("events of a sweep", () => {
  it("raise its version, and that of lists if it was created or steered", () => {
    const run = { id: "r", sweep: "s", spec: {}, status: "running" } as unknown as Run;
    const once = reduce(INITIAL_STATE, { type: "run", run });
    expect(once.sweepVersions.get("s")).toBe(1);
    const again = reduce(once, { type: "run", run: { ...run, generation: 2 } });
    expect([again.sweepVersions.get("s"), again.listVersion]).toEqual([2, once.listVersion]);
    const steered = reduce(again, { type: "sweep", sweep: "s" });
    expect([steered.sweepVersions.get("s"), steered.listVersion]).toEqual([3, again.listVersion + 1]);
  });
});
