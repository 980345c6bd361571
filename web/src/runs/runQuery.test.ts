import { describe, expect, it } from "vitest";
import { ariaSort, groupsSweeps, isFiltered, nextSort, queryOf } from "./Filters";

describe("the list of runs in the address", () => {
  const query = (text: string) => queryOf(new URLSearchParams(text));

  it("asks for the filters of the address, and ignores unknown values", () => {
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

  it("shows each sweep as one row while the address asks for nothing", () => {
    expect(groupsSweeps(query(""))).toBe(true);
    expect(groupsSweeps(query("q=thick"))).toBe(false);
    const id = "01234567-89ab-cdef-0123-456789abcdef";
    expect(query(`sweep=${id}`)).toEqual({ sweep: id });
    expect(query("sweep=x")).toEqual({});
  });

  it("is sorted by a column, then in reverse, then by default", () => {
    const next = ["name", "-name", "best"].map((sort) => nextSort(sort, "name", false));
    expect(next).toEqual(["-name", null, "name"]);
    expect(nextSort(undefined, "qd_score", true)).toBe("-qd_score");
    expect(nextSort("-qd_score", "qd_score", true)).toBe("qd_score");
    const order = ["name", "-name", undefined].map((sort) => ariaSort(sort, "name"));
    expect(order).toEqual(["ascending", "descending", "none"]);
  });
});
