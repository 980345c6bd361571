import { describe, expect, it } from "vitest";
import type { Choices, Run } from "../api/types";
import { groupsOf, refusalOf } from "./choices";

const choices = (...items: [generation: number | null, creature: string][]): Choices => ({
  items: items.map(([generation, creature]) => ({ generation, creature })),
  refusal: null,
});
const run = (status: string) => ({ status }) as Run;

describe("choices", () => {
  it("are shown by generation, those that wait first, then the newest", () => {
    const found = groupsOf(choices([4, "aa"], [4, "bb"], [9, "aa"], [null, "cc"]));
    expect(found).toEqual([
      { generation: null, creatures: ["cc"] },
      { generation: 9, creatures: ["aa"] },
      { generation: 4, creatures: ["aa", "bb"] },
    ]);
    expect(groupsOf(choices())).toEqual([]);
  });

  it("are refused once a run has ended, or for the server's reason", () => {
    expect(["queued", "running", "paused"].map((status) => refusalOf(run(status), choices()))).toEqual([
      null,
      null,
      null,
    ]);
    expect(refusalOf(run("cancelled"), choices())).toMatch("The run has ended");
    const refusal = "`search.emitters` must be others";
    expect(refusalOf(run("running"), { items: [], refusal })).toBe(refusal);
  });
});
