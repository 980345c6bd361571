import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { endReasonOf } from "./endReason";

describe("why a run ended", () => {
  const run = { generations: 50, spec: { search: { stop: { evaluations: 5000 } } } } as unknown as Run;
  it.each([
    [null, "Completed all 50 generations."],
    [
      "evaluations after generation 12",
      "Ended after generation 12: it used its budget of 5,000 evaluations.",
    ],
    ["device_hours after generation 3", "Ended early: device hours after generation 3."],
  ])("%j is told as %j", (ended, sentence) => {
    expect(endReasonOf({ ...run, summary: ended ? { ended } : null })).toBe(sentence);
  });
});
