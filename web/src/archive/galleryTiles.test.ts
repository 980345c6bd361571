import { describe, expect, it } from "vitest";
import { cornerOf, visibleBins } from "./galleryTiles";

describe("a wall of creatures", () => {
  it("has the first axis to the right, the second upwards", () => {
    expect(cornerOf(0, [3, 2], 10)).toEqual([0, 10]);
    expect(cornerOf(5, [3, 2], 10)).toEqual([20, 0]);
  });

  it("shows the filled tiles in the window, those in its middle first", () => {
    const window = { left: 15, top: 0, width: 15, height: 10 };
    expect(visibleBins([0, 1, 2, 3, 4, 5], [3, 2], 10, window)).toEqual([5, 3]);
    expect(visibleBins([0, 1], [3, 2], 10, window)).toEqual([]);
  });
});
