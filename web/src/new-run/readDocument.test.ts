import { describe, expect, it } from "vitest";
import type { Creature, Json, Spec } from "../api/types";
import { baseOfDocument, completeSpec, readDocument, readText } from "./sources";
import { EXPERIMENTS, PRESETS, experiment } from "./form/form.fixture";
import { withDefaults } from "./form/schema";
import { schemaErrors } from "./form/document";
import { formOf } from "./form/fields";

const creature = (genome: Spec, extra: Spec = {}) =>
  ({
    identity: {
      format: "microcosmos-creature/1",
      genome,
      world: { width: 96, height: 64, viscosity: 0.2, magic: "capped", coupling: { theta_feedback: 0 } },
      body: { builder: "ring", nodes: 20 },
      task: { steps: 70, fitness: "displacement" },
    },
    sha256: "ab".repeat(32),
    ...extra,
  }) as unknown as Creature;

describe("a pasted or dropped document", () => {
  it("is a spec, a run, or a creature", () => {
    const spec = { experiment: "gaits" };
    expect(readText(JSON.stringify(spec))).toEqual({ kind: "spec", spec });
    expect(readText(JSON.stringify({ id: "a run", spec }))).toEqual({ kind: "run", id: "a run", spec });
    const file = creature({ encoding: "cppn", control: { period: 50 } });
    expect(readDocument(file as unknown as Json)).toMatchObject({ kind: "creature", creature: file });
  });

  it.each([
    ["{", /Not valid JSON/],
    ["[1]", /got a list/],
    ['{"experiment": "gaits", "seed": 1, "seed": 2}', /Not valid JSON.*“seed” is given twice/],
    ["7", /got number 7/],
    ["{}", /“experiment” must name the experiment; got nothing/],
    ['{"spec": {"experiment": 3}}', /“spec.experiment” .* got number 3/],
    ["\u0089HDF", /HDF5/],
    ["\ufffdHDF", /HDF5/],
  ])("is refused as %j with the accepted documents", (text, words) => {
    expect(() => readText(text)).toThrow(words);
    expect(() => readText(text)).toThrow(/a spec, a run from the API, or a creature file/);
  });
});

describe("a creature", () => {
  it("gives its world, body, coupling, controller, room and task to a search", () => {
    const file = creature({ encoding: "cppn", control: { period: 50 } }, { measured: { room: [30, 80] } });
    const read = readDocument(file as unknown as Json);
    const spec = completeSpec(read.spec, EXPERIMENTS) as { [part: string]: Spec };
    expect(spec.experiment).toBe("quality-diversity");
    expect(spec.world).toMatchObject({ width: 96, height: 64, viscosity: 0.2, fluid: true });
    expect(spec.world).not.toHaveProperty("coupling");
    expect(spec.coupling).toMatchObject({ theta_feedback: 0, force_factor: 2 });
    expect(spec.control).toMatchObject({ encoding: "cppn", period: 50, angle_scale: 0.5 });
    expect(spec.genome).toMatchObject({ max_nodes: 30, max_connections: 80, weight_rate: 0.6 });
    expect(spec.task).toMatchObject({ steps: 70 });
    expect(schemaErrors(formOf(experiment("quality-diversity").schema), spec)).toEqual([]);
  });

  it("with numeric genes is searched with an emitter for numbers", () => {
    const { spec } = readDocument(creature({ encoding: "direct", control: {} }) as unknown as Json);
    const full = completeSpec(spec, EXPERIMENTS) as { search: { emitters: Spec[] }; control: Spec };
    expect(full.control.encoding).toBe("direct");
    expect(full.search.emitters).toEqual([
      { operator: "iso+line", select: "mixed", share: 1, iso: 0.1, line: 0.2 },
    ]);
  });

  it("with a gait by hand, or with a fold, gives an experiment of its kind", () => {
    const gait = { encoding: "gait", swimmer: "ray", period: 300, ramp: 2 };
    const sweep = readDocument(creature(gait) as unknown as Json).spec;
    expect(sweep).toMatchObject({ experiment: "gaits", swimmers: ["ray"], period: 300, viscosities: [0.2] });
    const fold = readDocument(creature({ encoding: "fold", control: { lengths: "raw" } }) as unknown as Json);
    expect(fold.spec).toMatchObject({ experiment: "folding", steps: 70, size: 42 });
    expect(completeSpec(fold.spec, EXPERIMENTS).control).toEqual({ encoding: "fold", lengths: "raw" });
  });

  it("is refined if refinement is selected", () => {
    const file = creature({ encoding: "cppn", control: {} }) as unknown as Json;
    const base = baseOfDocument(readDocument(file, true), "", EXPERIMENTS);
    expect(base).toMatchObject({
      kind: "creature",
      fromDocument: true,
      spec: { experiment: "refinement", creature: file },
    });
    expect(base.spec.steps).toBe(20);
  });
});

describe("a spec", () => {
  it.each(PRESETS)("of %s is complete, and its experiment alone gets defaults", (_, one, preset) => {
    expect(withDefaults(one.schema, preset.spec)).toEqual(preset.spec);
    const bare = withDefaults(one.schema, { experiment: one.experiment });
    expect(schemaErrors(formOf(one.schema), bare)).toEqual([]);
  });

  it("keeps its values in sections that are incomplete", () => {
    const { schema } = experiment("quality-diversity");
    const given = { experiment: "quality-diversity", body: { nodes: 12 }, world: { steric: { limit: 0.2 } } };
    const full = withDefaults(schema, given) as { [part: string]: Spec };
    expect(full.body).toEqual({ builder: "chain", nodes: 12, spacing: 1, stretch: 1, shear: 1, bend: 1 });
    expect(full.world!.steric).toEqual({ strength: 4, limit: 0.2, smoothing: "gaussian" });
    const odd = withDefaults(schema, { ...given, surprise: 1, body: { builder: "dragon" } });
    expect(odd).toMatchObject({ surprise: 1, body: { builder: "dragon" } });
  });

  it("of an unknown experiment is refused with the known ones", () => {
    expect(() => completeSpec({ experiment: "astrology" }, EXPERIMENTS)).toThrow(
      /quality-diversity.*got astrology/,
    );
  });
});
