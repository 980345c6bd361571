/** Runs that begin from creatures: what is sent of them, and how the address names them. */

import { describe, expect, inject, it, vi } from "vitest";
import type { Json, Spec } from "../src/api/types";
import { addressOf } from "../src/live/draft";
import { isAboutOrigin } from "../src/pages/new/ForkCard";
import { forkOf } from "../src/pages/new/forking";
import { addressed, load } from "../src/pages/new/sources";
import { formOf } from "../src/view/form/fields";
import { placesOf } from "../src/view/form/document";
import { mergePatch, withOrigin, withoutOrigin } from "../src/view/form/forking";

const EXPERIMENTS = inject("experiments");
const SEARCH = EXPERIMENTS.find(({ experiment }) => experiment === "quality-diversity")!;
const SPEC = SEARCH.presets[0]!.spec;
const SHA = "ab".repeat(32);
const RUN = "0190a6a0-0000-7000-8000-000000000001";

const RUNS: Record<string, Spec> = {
  [RUN]: withOrigin(SPEC, [SHA]),
  table: { experiment: "gaits" },
};
const CREATURE = {
  identity: {
    format: "microcosmos-creature/1",
    genome: { encoding: "cppn", control: { period: 50 } },
    world: { width: 96, height: 64, viscosity: 0.2, coupling: {} },
    body: { builder: "ring", nodes: 20 },
    task: { steps: 70, fitness: "displacement" },
  },
  sha256: SHA,
};

vi.mock("../src/api/client", () => ({
  readRun: async (id: string) => ({ id, spec: RUNS[id] }),
  readArchive: async () => ({ creature: ["x", "y", "z"] }),
  readCreature: async () => CREATURE,
}));

/** As the server applies it. */
function patched(document: Json | undefined, patch: Json): Json {
  if (patch === null || typeof patch !== "object" || Array.isArray(patch)) return patch;
  const object = document && typeof document === "object" && !Array.isArray(document);
  const whole: Spec = object ? { ...document } : {};
  for (const [key, value] of Object.entries(patch)) {
    if (value === null) delete whole[key];
    else whole[key] = patched(whole[key], value);
  }
  return whole;
}

describe("a merge patch", () => {
  it.each<[string, from: Spec, to: Spec, patch: Spec]>([
    ["says nothing of what is the same", { a: 1, b: { c: [1, { d: null }] } }, { b: { c: [1, { d: null }] }, a: 1 }, {}],
    ["names only what differs within parts", { a: { b: 1, c: 2 }, d: 3 }, { a: { b: 1, c: 4 }, d: 3 }, { a: { c: 4 } }],
    ["takes away by null", { a: { b: 1, c: 2 }, d: 3 }, { a: { b: 1 } }, { a: { c: null }, d: null }],
    ["replaces lists whole", { a: [1, { b: 2 }] }, { a: [1, { b: 2 }, 3] }, { a: [1, { b: 2 }, 3] }],
    ["puts a part in the place of a value", { a: null, b: [1] }, { a: { c: 1 }, b: { d: 2 } }, { a: { c: 1 }, b: { d: 2 } }],
    ["empties a part", { a: { b: 1 } }, { a: {} }, { a: { b: null } }],
    ["puts an empty part where there was none", { a: 1 }, { a: {} }, { a: {} }],
  ])("%s", (_, from, to, patch) => {
    expect(mergePatch(from, to)).toEqual(patch);
    expect(patched(from, patch)).toEqual(to);
  });

  it("leads from each preset of a search to each other", () => {
    const specs = EXPERIMENTS.filter(({ experiment }) => /quality|neuro/.test(experiment)).flatMap(
      ({ presets }) => presets.map(({ spec }) => spec),
    );
    expect(specs.length).toBeGreaterThan(3);
    const bare = (spec: Spec) => JSON.parse(JSON.stringify(spec, (_, value) => value ?? undefined));
    for (const from of specs) {
      for (const to of specs) expect(bare(patched(from, mergePatch(from, to)) as Spec)).toEqual(bare(to));
    }
  });
});

describe("a fork", () => {
  const base = { kind: "run" as const, name: RUN, spec: withOrigin(SPEC, []) };
  const spec = { ...base.spec, world: { ...(SPEC.world as Spec), viscosity: 0.3 } };

  it("is sent as what differs, with whom it begins from", () => {
    const all = { ...base, fork: { run: RUN, creature: null, creatures: 7 } };
    expect(forkOf({ base: all, spec }, "  thick ")).toEqual({
      fork: { run: RUN, from: { archive: true }, spec: { world: { viscosity: 0.3 } }, name: "thick" },
    });
    const one = { ...base, fork: { run: RUN, creature: SHA, creatures: 1 } };
    expect(forkOf({ base: one, spec: base.spec }, "")).toEqual({
      fork: { run: RUN, from: { creatures: [SHA] }, spec: {}, name: null },
    });
  });

  it("takes no other names of creatures, typed as JSON or into a field", () => {
    const fork = { run: RUN, creature: null, creatures: 7 };
    const sent = forkOf({ base: { ...base, fork }, spec: withOrigin(spec, [SHA]) }, "");
    expect(sent).toMatchObject({ fork: { spec: { world: { viscosity: 0.3 } } } });
    const form = formOf(SEARCH.schema);
    const places = placesOf(form, spec).filter((path) => path !== "search.origin");
    expect(placesOf(form, spec)).toContain("search.origin");
    expect(placesOf(withoutOrigin(form), spec)).toEqual(places);
  });

  it("is a run as any other where no run is known, or nobody to begin from", () => {
    const alone = { ...base, fork: { run: null, creature: SHA, creatures: 1 } };
    expect(forkOf({ base: alone, spec }, "")).toBeNull();
    expect(forkOf({ base, spec }, "")).toBeNull();
  });

  it.each([
    [`fork=${RUN}`, ["fork", RUN], { run: RUN, creature: null, creatures: 7 }],
    [`fork=${RUN}&creature=${SHA}`, ["fork", RUN, SHA], { run: RUN, creature: SHA, creatures: 1 }],
    [`begin=${SHA}`, ["begin", SHA], { run: null, creature: SHA, creatures: 1 }],
  ])("is named by the address %s", (text, address, fork) => {
    expect(addressed(new URLSearchParams(text))).toEqual(address);
    expect(addressOf({ ...base, fork })).toEqual(address);
  });

  it.each(["from", "from.region.speed", "search.origin", "name", "generation"])("shows %s beside it", (field) => {
    expect(isAboutOrigin(field)).toBe(true);
  });

  it.each(["search.batch", "genome.max_nodes", "control", "search.generations"])("leaves %s in the form", (field) => {
    expect(isAboutOrigin(field)).toBe(false);
  });
});

describe("what an address of a fork names", () => {
  it("is the run's spec, with how many creatures live there", async () => {
    const base = await load(["fork", RUN], EXPERIMENTS);
    expect(base.fork).toEqual({ run: RUN, creature: null, creatures: 3 });
    expect((base.spec.search as Spec).origin).toEqual([]);
  });

  it("is the creature's own world where its run was no search", async () => {
    const base = await load(["fork", "table", SHA], EXPERIMENTS);
    expect(base).toMatchObject({ kind: "creature", fork: { run: null, creature: SHA } });
    expect(base.spec).toMatchObject({ world: { width: 96 }, search: { origin: [SHA] } });
    await expect(load(["fork", "table"], EXPERIMENTS)).rejects.toThrow("fills no archive");
  });
});
