import { describe, expect, it } from "vitest";
import type { Curves } from "../../store/curves";
import { scoresOf, workOf } from "./plots";

describe("curves", () => {
  const figures = { qd_score: [1], coverage: [0.5], best: [2] };
  const bare = { generation: [1], evaluations: [16], seconds: [2], ...figures, summary: {} };

  it("have re-evaluations and work if they were reported", () => {
    expect(scoresOf(bare).map(({ series }) => series.length)).toEqual([1, 1, 1]);
    expect(workOf(bare)).toEqual([]);
    const told: Curves = {
      ...bare,
      summary: {
        corrected_qd_score: [0.8],
        "neat: inserted": [3],
        "iso+line: inserted": [4],
        "neat: improved": [0],
        device_seconds: [0.1],
      },
    };
    expect(scoresOf(told)[0]!.series[1]).toMatchObject({ y: [0.8], dots: true });
    expect(workOf(told).map(({ title, series }) => [title, ...series.map(({ name }) => name)])).toEqual([
      ["Into empty cells", "neat", "iso+line"],
      ["Improvements", "neat"],
      ["Device-seconds", "device_seconds"],
    ]);
  });
});
