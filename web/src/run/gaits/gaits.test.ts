import { describe, expect, it } from "vitest";
import type { ResultRow, Spec } from "../../api/types";
import { reynoldsAxis, plotAxes, plotLines } from "./GaitsRun";

const row = (values: Partial<ResultRow>): ResultRow => ({ creature: null, ...values });

describe("displacements of gaits", () => {
  const spec: Spec = { swimmers: ["worm", "ray"], viscosities: [0.01, 1], forms: ["ours"] };
  const point = (values: Partial<ResultRow>) =>
    row({ form: "ours", status: "ok", swimmer: "worm", limited: 0, warnings: "", ...values });
  const rows = [
    point({ viscosity: 1, displacement: 0.5, reynolds: 2, creature: "ab" }),
    point({ viscosity: 0.01, displacement: 3, reynolds: 200, limited: 0.1 }),
    point({ viscosity: 0.01, swimmer: "ray", displacement: null, status: "non-finite" }),
  ];
  const [worm, ray] = plotLines(spec, rows, (sha) => `/creatures/${sha}`);

  it("has a line for each swimmer, from the lowest viscosity to the highest", () => {
    expect(worm!.points.map(({ x, y }) => `${x} ${y}`)).toEqual(["0.01 3", "1 0.5"]);
    expect(worm!.points[1]!.href).toBe("/creatures/ab");
    expect(worm!.points[1]!.tooltip).toEqual(["Worm at ν = 1", "0.5 cells per cycle", "Reynolds number 2"]);
  });

  it("marks doubtful and unfinished simulations", () => {
    expect(worm!.points.map(({ hollow }) => hollow)).toEqual([true, false]);
    expect(worm!.points[0]!.tooltip).toContain("limits active in 10 % of node steps");
    expect(ray!.points[0]!.y).toBeNull();
    expect(ray!.points[0]!.tooltip[1]).toBe("Non-finite");
  });

  it("has the worm's Reynolds numbers above its viscosities", () => {
    expect(reynoldsAxis(rows)).toEqual({
      title: "Reynolds number of the worm",
      ticks: [
        { at: 0.01, text: "200" },
        { at: 1, text: "2" },
      ],
    });
    expect(reynoldsAxis([rows[2]!])).toBeNull();
  });

  it("ignores unfinished simulations in its axis", () => {
    const burst = point({ viscosity: 1, displacement: 1e6, status: "supersonic" });
    expect(plotAxes(spec, [...rows, burst]).y.scale).toEqual(plotAxes(spec, rows).y.scale);
  });

  it("has the same axes before its results and after", () => {
    expect(plotAxes(spec, []).x).toEqual(expect.objectContaining({ scale: plotAxes(spec, rows).x.scale }));
  });
});
