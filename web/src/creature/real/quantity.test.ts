import { describe, expect, it } from "vitest";
import { lengthOf, periodOf, problemOf, realOf } from "./quantity";

describe("real quantities", () => {
  it("are read with their unit", () => {
    expect(lengthOf("50 µm")).toBeCloseTo(5e-5, 12);
    expect(periodOf("20ms")).toBeCloseTo(0.02, 12);
    for (const wrong of ["", "1", "mm", "0 mm", "-1 mm", "1..2 mm", "1 s", "1e200m", "1e-200 m"])
      expect(lengthOf(wrong)).toBeNull();
  });

  it("count only together", () => {
    expect(realOf({ length: "1 mm", period: "0.5 s" })).toEqual({ length: 1e-3, period: 0.5 });
    expect(realOf({ length: "1 mm", period: "" })).toBeNull();
  });

  it.each([
    ["", "", null],
    ["1 mm", "0.5 s", null],
    ["1", "0.5 s", "Body length must be a number above 0 with a unit"],
    ["1 mm", "0.5 m", "Stroke must be a number above 0 with a unit"],
    ["", "1 s", "Give the body length too"],
    ["1 mm", "", "Give the period of a stroke too"],
  ])("of %j and %j have the problem %j", (length, period, problem) => {
    const found = problemOf({ length, period });
    if (problem === null) expect(found).toBeNull();
    else expect(found).toContain(problem);
  });
});
