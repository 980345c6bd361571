import { describe, expect, it } from "vitest";
import type { Creature } from "../api/types";
import { physicalRows, shown } from "./FactsCard";
import { problemOf } from "./RealFields";

const creature = {
  identity: {
    world: { viscosity: 0.1 },
    genome: { encoding: "cppn", control: { period: 20, timer: "sine-cosine" } },
  },
  measured: { measures: { speed: 0.5, reynolds: 0.3 } },
} as unknown as Creature;

describe("physical units", () => {
  it("are those of the server's scales", () => {
    const scales = {
      cell: 1e-4,
      step: 0.025,
      viscosity: 4e-8,
      fluid: "as tar",
      speed: 4e-5,
      node_speed: 4e-5,
    };
    expect(Object.fromEntries(physicalRows(creature, scales))).toEqual({
      Speed: "20 µm/s",
      "Speed of the nodes": "12 µm/s",
      "Kinematic viscosity": "0.04 mm²/s, as tar",
      Cell: "100 µm",
      Step: "25 ms",
    });
  });

  it("have prefixes", () => {
    expect(shown(2.7e-4, "m/s")).toBe("270 µm/s");
    expect(shown(0, "m/s")).toBe("0 m/s");
  });

  it.each([
    ["", "", [], null],
    ["1 mm", "0.5 s", [], null],
    ["1", "0.5 s", ["length"], "Body length must be a number above 0 with a unit"],
    ["1 mm", "0.5 m", ["period"], "Stroke must be a number above 0 with a unit"],
    ["", "1 s", [], "Give the body length too"],
    ["1 mm", "", [], "Give the period of a stroke too"],
  ])("of %j and %j, of which %j are wrong, have the problem %j", (length, period, wrong, problem) => {
    const found = problemOf({ length, period }, { wrong });
    if (problem === null) expect(found).toBeNull();
    else expect(found).toContain(problem);
  });
});
