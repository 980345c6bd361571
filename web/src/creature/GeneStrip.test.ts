import { describe, expect, it } from "vitest";
import { barsOf } from "./GeneStrip";

describe("a strip of genes", () => {
  it("has a bar for each, or for the farthest of several where there are very many", () => {
    expect(barsOf(Float32Array.from([0.5, -1]))).toEqual([0.5, -1]);
    const many = Float32Array.from({ length: 4000 }, (_, i) => (i === 13 ? -1 : 0.25));
    const bars = barsOf(many);
    expect([bars.length, bars[1], bars[0]]).toEqual([400, -1, 0.25]);
  });
});
