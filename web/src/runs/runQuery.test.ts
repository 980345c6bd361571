import { describe, expect, it } from "vitest";
import { ariaSort, isFiltered, nextSort, queryOf } from "./runQuery";

describe("the list of runs in the address", () => {
  const query = (text: string) => queryOf(new URLSearchParams(text));

  it("asks for what the address says, and passes over what makes no sense", () => {
    expect(query("")).toEqual({});
    expect(query("q=wide &status=running,odd,queued&tag=a&experiment=gaits&sort=-best")).toEqual({
      q: "wide ",
      status: ["queued", "running"],
      tag: "a",
      experiment: ["gaits"],
      sort: "-best",
    });
    expect(query("sort=colour&status=odd")).toEqual({});
    expect([isFiltered(query("sort=best")), isFiltered(query("q=x"))]).toEqual([false, true]);
  });

  it("is sorted by a column, then the other way round, then as usual", () => {
    expect(["name", "-name", "best"].map((sort) => nextSort(sort, "name", false))).toEqual([
      "-name",
      null,
      "name",
    ]);
    expect(nextSort(undefined, "qd_score", true)).toBe("-qd_score");
    expect(nextSort("-qd_score", "qd_score", true)).toBe("qd_score");
    expect(["name", "-name", undefined].map((sort) => ariaSort(sort, "name"))).toEqual([
      "ascending",
      "descending",
      "none",
    ]);
  });
});
