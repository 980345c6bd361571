import { describe, expect, it } from "vitest";
import type { Creature } from "../api/types";
import { like, physicalRows, shown, strokeOf } from "./physical";

const creature = {
  identity: {
    world: { viscosity: 0.1 },
    genome: { encoding: "cppn", control: { period: 20, timer: "sine-cosine" } },
  },
  measured: { measures: { speed: 0.5, reynolds: 0.3 } },
} as unknown as Creature;

describe("physical units", () => {
  it("follow from a length and a period", () => {
    // Ten cells of 0.1 mm, twenty steps of 25 ms: 0.5 lengths in 1,000 steps are 0.5 mm in 25 s.
    const rows = Object.fromEntries(physicalRows(creature, { length: 1e-3, period: 0.5 }, 10, 20));
    expect(rows).toMatchObject({
      Speed: "20 µm/s",
      Cell: "100 µm",
      Step: "25 ms",
      // Re ν / L with ν = 0.1 (0.1 mm)² / 25 ms.
      "Speed of the nodes": "12 µm/s",
    });
    expect(rows["Kinematic viscosity"]).toMatch(/^0.04 mm²\/s, less than common liquids/);
  });

  it("need a stroke and a fluid", () => {
    expect(strokeOf(creature)).toBe(20);
    const { genome, world } = creature.identity;
    const changed = (identity: object) => ({ ...creature, identity }) as unknown as Creature;
    expect(strokeOf(changed({ world: { ...world, fluid: false }, genome }))).toBeNull();
    expect(strokeOf(changed({ world, genome: { control: { period: 20, timer: "linear" } } }))).toBeNull();
  });

  it("name the fluid and have prefixes", () => {
    expect(like(1e-6)).toBe("as water");
    expect(like(5e-6)).toBe("between ethanol and air");
    expect(like(0.07)).toBe("10 times that of honey");
    expect(shown(2.7e-4, "m/s")).toBe("270 µm/s");
    expect(shown(0, "m/s")).toBe("0 m/s");
  });
});
