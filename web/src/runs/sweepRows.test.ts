import { describe, expect, it } from "vitest";
import { groupsSweeps, queryOf } from "./runQuery";

describe("the list of runs", () => {
  it("has runs of sweeps stand as one as long as nothing is asked of it", () => {
    expect(groupsSweeps(queryOf(new URLSearchParams()))).toBe(true);
    expect(groupsSweeps(queryOf(new URLSearchParams("q=thick")))).toBe(false);
    const id = "01234567-89ab-cdef-0123-456789abcdef";
    expect(queryOf(new URLSearchParams(`sweep=${id}`))).toEqual({ sweep: id });
    expect(queryOf(new URLSearchParams("sweep=x"))).toEqual({});
  });
});
