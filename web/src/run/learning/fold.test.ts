import { describe, expect, it } from "vitest";
import { placeOf } from "./fold";

describe("the picture under a filament", () => {
  it("lies in the middle of the world, as large as the spec has it", () => {
    const target = { name: "3", width: 8, height: 16, size: 32, pixels: "" };
    expect(placeOf(target, [48, 64])).toEqual({ left: 15.5, top: 47.5, wide: 16, high: 32 });
  });
});
