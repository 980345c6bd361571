import { afterEach, describe, expect, it, vi } from "vitest";
import { opensByItself } from "./guide";

const visited = (guided: boolean) => vi.stubGlobal("localStorage", { getItem: () => (guided ? "1" : null) });

describe("the tour", () => {
  afterEach(() => vi.unstubAllGlobals());

  it.each([
    [true, false, true],
    [false, false, false],
    [true, true, false],
  ])("over a demonstration (%s), taken before (%s), opens by itself: %s", (demonstration, guided, opens) => {
    visited(guided);
    expect(opensByItself({ demonstration })).toBe(opens);
  });
});
