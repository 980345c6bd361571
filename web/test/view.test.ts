import { describe, expect, it } from "vitest";
import type { Creature, Run, Spec } from "../src/api/types";
import type { Replay } from "../src/frames/replay";
import { diverging, viridis } from "../src/view/colours";
import { bytes, duration, number, titleOf } from "../src/view/format";
import { couplingFacts, freedomOf, isFree } from "../src/view/coupling";
import { measurementsOf, originOf } from "../src/view/facts";
import { type Point, chainsOf, meanOf, positionsAt, splineOf } from "../src/view/replay/motion";
import { routeOf } from "../src/router";

describe("motion", () => {
  const replay = {
    header: { frames: 2, nodes: 2 },
    positions: Float32Array.from([0, 0, 2, 0, 1, 2, 3, 2]),
  } as Replay;

  it("is linear between recorded frames and stops at the last", () => {
    expect(positionsAt(replay, 0.5)).toEqual([
      [0.5, 1],
      [2.5, 1],
    ]);
    expect(meanOf(positionsAt(replay, 1))).toEqual([2, 2]);
  });

  it("draws a chain as one line, a ring closed, a star as its arms", () => {
    expect(
      chainsOf([
        [0, 1],
        [1, 2],
        [2, 3],
      ]),
    ).toEqual([[0, 1, 2, 3]]);
    expect(
      chainsOf([
        [0, 1],
        [1, 2],
        [2, 0],
      ]),
    ).toEqual([[0, 1, 2, 0]]);
    expect(
      chainsOf([
        [0, 1],
        [0, 2],
        [0, 3],
      ]),
    ).toEqual([
      [0, 1],
      [0, 2],
      [0, 3],
    ]);
    expect(
      chainsOf([
        [0, 1],
        [2, 3],
      ]),
    ).toEqual([
      [0, 1],
      [2, 3],
    ]);
  });

  it("goes through every node, and straight where the nodes are in line", () => {
    const line: Point[] = [
      [0, 0],
      [1, 1],
      [2, 2],
    ];
    const pieces = splineOf(line);
    expect(pieces.map(([, , end]) => end)).toEqual(line.slice(1));
    for (const [a, b] of pieces) for (const [x, y] of [a, b]) expect(y).toBeCloseTo(x, 12);
  });
});

describe("colours", () => {
  it("of viridis begin dark violet, end yellow, and grow lighter all the way", () => {
    const lightness = Array.from({ length: 33 }, (_, i) => {
      const [red, green, blue] = viridis(i / 32);
      return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    });
    for (let i = 1; i < 33; i++) expect(lightness[i]!).toBeGreaterThan(lightness[i - 1]!);
    // The ends of the published map are (68, 1, 84) and (253, 231, 37).
    [68, 1, 84].forEach((value, k) => expect(Math.abs(viridis(0)[k]! - value)).toBeLessThan(5));
    [253, 231, 37].forEach((value, k) => expect(Math.abs(viridis(1)[k]! - value)).toBeLessThan(5));
  });

  it.each(["light", "dark"] as const)("for vorticity are clipped and opposite in %s", (theme) => {
    expect(diverging(-2, theme)).toEqual(diverging(-1, theme));
    expect(diverging(-1, theme)[2]).toBeGreaterThan(diverging(-1, theme)[0]);
    expect(diverging(1, theme)[0]).toBeGreaterThan(diverging(1, theme)[2]);
  });
});

describe("words for people", () => {
  it.each([
    [0, "0"],
    [0.012345, "0.0123"],
    [1234.5, "1,235"],
    [98300000, "9.83 × 10⁷"],
    [0.0001, "10⁻⁴"],
    [-0.0343574, "−0.0344"],
    [null, "–"],
  ])("write %j as %s", (value, text) => {
    expect(number(value)).toBe(text);
  });

  it("keep times and sizes short", () => {
    expect([0.2, 59, 61, 3700, 90000].map(duration)).toEqual([
      "under 1 s",
      "59 s",
      "1 min 1 s",
      "1 h 1 min",
      "1 d 1 h",
    ]);
    expect(bytes(15_100_000)).toBe("15.1 MB");
  });

  it("name a run after its preset whatever its seed, else after its experiment", () => {
    const spec: Spec = { seed: 0, world: { width: 32, height: 32 } };
    const presets = [{ name: "demo", title: "", spec }];
    const known = [{ experiment: "quality-diversity", title: "", schema: {}, presets }];
    const run = { experiment: "quality-diversity", demonstration: false } as Run;
    const same = { world: { height: 32, width: 32 }, seed: 9 };
    expect(titleOf({ ...run, spec: same }, known)).toBe("Demo");
    expect(titleOf({ ...run, spec: { seed: 0 } }, known)).toBe("Quality diversity");
    const gaits = known.map((one) => ({ ...one, experiment: "gaits" }));
    expect(titleOf({ ...run, experiment: "gaits", spec: same }, gaits)).toBe("Gaits, demo");
  });
});

describe("a creature file", () => {
  const identity = {
    genome: { encoding: "cppn" },
    body: { nodes: 8 },
    world: { width: 64, height: 32, viscosity: 0.05 },
  };
  const told = (creature: Creature) =>
    Object.fromEntries([...measurementsOf(creature), ...originOf(creature)]);
  const bare = { identity, measured: null, provenance: null, licence: "CC0" } as unknown as Creature;

  it("without figures and origin says so", () => {
    expect(told(bare)).toEqual({
      Fitness: "not measured",
      Generation: "unknown",
      "Made by": "unknown",
      Seed: "unknown",
      Genome: "a network that controls",
      Body: "Chain, 8 nodes",
      World: "64 × 32 cells, ν = 0.05",
      Device: "unknown",
      Licence: "CC0",
    });
  });

  it("with figures shows each of them, zeros too", () => {
    const measured = { fitness: 0, descriptors: { speed: 0.5 }, features: {}, block: 1, device: "cpu" };
    const provenance = { parents: [], operator: "random", generation: 0, seed: 0, version: "1" };
    const facts = told({ ...bare, measured, provenance });
    expect(facts).toMatchObject({ Fitness: "0", Speed: "0.5", Generation: "0", Seed: "0" });
  });

  it("of a gait names swimmer and period, and figures with their units", () => {
    const genome = { encoding: "gait", swimmer: "worm", period: 600, ramp: 1 };
    const measured = {
      fitness: 2,
      descriptors: {},
      features: { cycle: 2, reynolds: 12.5, limited: 0.25 },
      block: 1,
      device: "cpu",
    };
    const worm = { ...bare, identity: { ...identity, genome }, measured } as unknown as Creature;
    const facts = told(worm);
    expect(facts).toMatchObject({
      Swimmer: "Worm",
      Period: "600 steps",
      "In the last cycle": "2 cells",
      "Reynolds number": "12.5",
      "Limits active": "25 % of node steps",
    });
    expect(facts).not.toHaveProperty("Fitness");
  });

  it("says in which form its body is coupled, and whether that is force-free", () => {
    const paper = { projection: "none", theta_feedback: 0, layers: 2 };
    expect(isFree(paper)).toBe(false);
    expect(isFree({ projection: "force" })).toBe(true);
    expect(Object.fromEntries(couplingFacts(paper))).toMatchObject({
      "Forcing freed of": "nothing: not force-free",
      "Edge angles": "free, as in the paper",
      Forcing: "two layers, factor 2",
      "Actuator strength": "unlimited",
    });
  });

  it.each([
    [{ coupling: { projection: "force" } }, "all"],
    [{ coupling: { projection: "none" } }, "none"],
    [{ forms: ["ours", "paper"] }, "some"],
    [{ forms: ["paper"] }, "none"],
    [{ forms: ["ours", "strong"] }, "all"],
    [{}, "all"],
  ] as [Spec, string][])("of a run with %j is %s force-free", (spec, freedom) => {
    expect(freedomOf(spec)).toBe(freedom);
  });
});

describe("an address", () => {
  it.each([
    ["/", { page: "runs" }],
    ["/new", { page: "new" }],
    ["/runs/abc", { page: "run", id: "abc" }],
    ["/creatures/ff", { page: "creature", sha: "ff" }],
    ["/runs/abc/more", { page: "unknown" }],
    ["/runs/a%20b", { page: "run", id: "a b" }],
    ["/runs/%E0%A4%A", { page: "unknown" }],
    ["/creatures/%", { page: "unknown" }],
    ["/runs", { page: "unknown" }],
    ["/elsewhere", { page: "unknown" }],
  ])("%s leads to its page", (path, route) => {
    expect(routeOf(path)).toEqual(route);
  });
});
