import { describe, expect, it } from "vitest";
import type { Creature, Spec } from "../api/types";
import { couplingFacts, forceFreeShare, isForceFree } from "../ui/coupling";
import { groupsOf, originOf } from "./facts";

describe("a creature file", () => {
  const identity = {
    genome: { encoding: "cppn", control: {} },
    body: { nodes: 8 },
    world: { width: 64, height: 32, viscosity: 0.05 },
  };
  const factsOf = (creature: Creature) =>
    Object.fromEntries([...groupsOf(creature).flatMap(({ rows }) => rows), ...originOf(creature)]);
  const bare = {
    identity,
    measured: null,
    provenance: null,
    licence: "CC0",
    sha256: "ab",
  } as unknown as Creature;

  it("without measures and origin says so", () => {
    expect(factsOf(bare)).toEqual({
      Fitness: "not measured",
      Generation: "unknown",
      Operator: "unknown",
      "Random seed": "unknown",
      Genome: "a network that controls the body",
      Body: "Chain, 8 nodes",
      World: "64 × 32 cells, ν = 0.05",
      Device: "unknown",
      Licence: "CC0",
      "SHA-256": "ab",
    });
  });

  it("with measures shows each of them, also zeros", () => {
    const measured = { fitness: 0, descriptors: { speed: 0.5 }, measures: {}, block: 1, device: "cpu" };
    const provenance = { parents: [], operator: "random", generation: 0, seed: 0, version: "1" };
    const facts = factsOf({ ...bare, measured, provenance });
    expect(facts).toMatchObject({
      Fitness: "0",
      Speed: "0.5 lengths/1,000 steps",
      Generation: "0",
      "Random seed": "0",
    });
  });

  it("has the numbers of its flow together, the sperm number among them", () => {
    const measures = { mach: 0.05, strouhal: 0.4, reynolds: 2 };
    const measured = { fitness: 0, descriptors: {}, measures, block: 1, device: "cpu" };
    const creature = { ...bare, measured } as unknown as Creature;
    const flow = groupsOf(creature, 0.93).find(({ title }) => title === "Flow")!;
    expect(Object.fromEntries(flow.rows)).toEqual({
      "Reynolds number": "2",
      "Strouhal number": "0.4",
      "Sperm number": "0.93",
      "Largest Mach number": "0.05",
    });
    expect(Object.fromEntries(groupsOf(creature).flatMap(({ rows }) => rows))).not.toHaveProperty(
      "Sperm number",
    );
  });

  it("of a body that grows from a plan names its form", () => {
    const genome = { encoding: "body-graph", control: {} };
    const measures = { free_ends: 3, total_length: 22, form_symmetry: 0.75 };
    const measured = { fitness: 0, descriptors: {}, measures, block: 1, device: "cpu" };
    const body = { builder: "grown", nodes: 48 };
    const grown = { ...bare, identity: { ...identity, genome, body }, measured } as unknown as Creature;
    expect(factsOf(grown)).toMatchObject({
      Genome: "a plan that grows the body, and a network that drives it",
      Body: "Grown, at most 48 nodes",
      "Free ends": "3",
      "Total length": "22 cells",
      "Mirror symmetry at rest": "0.75",
    });
    expect(groupsOf(grown).map(({ title }) => title)).toEqual(["Result", "Body at rest"]);
  });

  it("of a gait names swimmer and period, and measures with their units", () => {
    const genome = { encoding: "gait", swimmer: "worm", period: 600, ramp: 1 };
    const measured = {
      fitness: 2,
      descriptors: {},
      measures: { cycle_x: 2, reynolds: 12.5, limited: 0.25 },
      block: 1,
      device: "cpu",
    };
    const worm = { ...bare, identity: { ...identity, genome }, measured } as unknown as Creature;
    const facts = factsOf(worm);
    expect(facts).toMatchObject({
      Swimmer: "Worm",
      Period: "600 steps",
      "Displacement along x in the last cycle": "2 cells",
      "Reynolds number": "12.5",
      "Node steps at a limit": "25 %",
    });
    expect(facts).not.toHaveProperty("Fitness");
  });

  it("describes the coupling, and whether it is force-free", () => {
    const paper = { projection: "none", theta_feedback: 0, layers: 2 };
    expect(isForceFree(paper)).toBe(false);
    expect(isForceFree({ projection: "force" })).toBe(true);
    expect(Object.fromEntries(couplingFacts(paper))).toMatchObject({
      "Removed from the forcing": "nothing (not force-free)",
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
    expect(forceFreeShare(spec)).toBe(freedom);
  });
});
