import { afterEach, describe, expect, it, vi } from "vitest";
import { opensByItself } from "./tour";

const visited = (taken: boolean) => vi.stubGlobal("localStorage", { getItem: () => (taken ? "1" : null) });

describe("the tour", () => {
  afterEach(() => vi.unstubAllGlobals());

  it.each([
    [true, false, true],
    [false, false, false],
    [true, true, false],
  ])("over a demonstration (%s), taken before (%s), opens by itself: %s", (demonstration, taken, opens) => {
    visited(taken);
    expect(opensByItself({ demonstration })).toBe(opens);
  });
});
