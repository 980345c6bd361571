import { describe, expect, it } from "vitest";
import type { Choices, Run } from "../api/types";
import { goesOn, groupsOf, withoutWaiting } from "./choices";

const choices = (...items: [generation: number | null, creature: string][]): Choices => ({
  items: items.map(([generation, creature]) => ({ generation, creature })),
  refusal: null,
});

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

  it("that wait already are not taken back with new ones", () => {
    const known = choices([null, "aa"], [4, "bb"]);
    expect(withoutWaiting(["aa", "bb", "cc"], known)).toEqual(["bb", "cc"]);
    expect(withoutWaiting(["aa"], choices())).toEqual(["aa"]);
  });

  it("can be made until a run has ended", () => {
    const can = (status: string) => goesOn({ status } as Run);
    expect(["queued", "running", "paused"].every(can)).toBe(true);
    expect(["finished", "failed", "cancelled"].some(can)).toBe(false);
  });
});
