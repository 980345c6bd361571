/** Forks: their requests and addresses. */

import { describe, expect, it, vi } from "vitest";
import type { Json, Spec } from "../api/types";
import { addressOf } from "../store/draft";
import { forkRequest, isForkField } from "./ForkCard";
import { MAX_CREATURES, sourceAddress, load } from "./sources";
import { EXPERIMENTS, experiment } from "./form/form.fixture";
import { type Section, formOf } from "./form/fields";
import { messagePaths } from "./form/document";
import { mergePatch, withInitial, withoutInitial } from "./initialCreatures";

const SEARCH = experiment("quality-diversity");
const SPEC = SEARCH.presets[0]!.spec;
const SHA = "ab".repeat(32);
const RUN = "0190a6a0-0000-7000-8000-000000000001";

const RUNS: Record<string, Spec> = {
  [RUN]: withInitial(SPEC, [SHA]),
  table: { experiment: "gaits" },
};
/** All current elites of a run. */
const OTHER = "cd".repeat(32);
const ALL = { run: RUN, named: null, cells: null, at: null, creatures: 3 };
const ONE = { ...ALL, named: [SHA], creatures: 1 };

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

vi.mock("../api/client", () => ({
  readRun: async (id: string) => ({ id, spec: RUNS[id], generation: 8 }),
  readArchive: async (_: string, __: string[], { generation }: { generation?: number }) => {
    if (generation === 0) return { cell: [], creature: [], generation };
    if ((generation ?? 8) > 8) throw new Error("the run is at generation 8");
    return { cell: [2, 3, 5, 9], creature: ["x", "y", "z", "x"], generation: generation ?? 8 };
  },
  readCreature: async () => CREATURE,
}));

/** Apply a patch as the server does. */
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
    ["omits equal values", { a: 1, b: { c: [1, { d: null }] } }, { b: { c: [1, { d: null }] }, a: 1 }, {}],
    ["names differing fields", { a: { b: 1, c: 2 }, d: 3 }, { a: { b: 1, c: 4 }, d: 3 }, { a: { c: 4 } }],
    ["removes by null", { a: { b: 1, c: 2 }, d: 3 }, { a: { b: 1 } }, { a: { c: null }, d: null }],
    ["replaces lists whole", { a: [1, { b: 2 }] }, { a: [1, { b: 2 }, 3] }, { a: [1, { b: 2 }, 3] }],
    ["objects for values", { a: null, b: [1] }, { a: { c: 1 }, b: { d: 2 } }, { a: { c: 1 }, b: { d: 2 } }],
    ["empties an object", { a: { b: 1 } }, { a: {} }, { a: { b: null } }],
    ["replaces a value by an empty object", { a: 1 }, { a: {} }, { a: {} }],
  ])("%s", (_, from, to, patch) => {
    expect(mergePatch(from, to)).toEqual(patch);
    expect(patched(from, patch)).toEqual(to);
  });

  it("turns each preset of a search into each other one", () => {
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
  const base = { kind: "run" as const, name: RUN, spec: withInitial(SPEC, []) };
  const spec = { ...base.spec, world: { ...(SPEC.world as Spec), viscosity: 0.3 } };

  it("is sent as the changed fields and its initial creatures", () => {
    const all = { ...base, fork: ALL };
    expect(forkRequest({ base: all, spec }, "  thick ")).toEqual({
      fork: { run: RUN, from: { archive: true }, spec: { world: { viscosity: 0.3 } }, name: "thick" },
    });
    const one = { ...base, fork: ONE };
    expect(forkRequest({ base: one, spec: base.spec }, "")).toEqual({
      fork: { run: RUN, from: { creatures: [SHA] }, spec: {}, name: null },
    });
  });

  it("names the cells and the generation of their elites", () => {
    const some = { ...base, fork: { ...ALL, cells: [2, 3, 9], at: 4 } };
    expect(forkRequest({ base: some, spec: base.spec }, "")).toEqual({
      fork: { run: RUN, from: { cells: [2, 3, 9] }, generation: 4, spec: {}, name: null },
    });
  });

  it("ignores initial creatures typed into its spec, and has no field for them", () => {
    const sent = forkRequest({ base: { ...base, fork: ALL }, spec: withInitial(spec, [SHA]) }, "");
    expect(sent).toMatchObject({ fork: { spec: { world: { viscosity: 0.3 } } } });
    const form = formOf(SEARCH.schema);
    const places = messagePaths(form, spec).filter((path) => path !== "search.initial");
    expect(messagePaths(form, spec)).toContain("search.initial");
    expect(messagePaths(withoutInitial(form), spec)).toEqual(places);
  });

  it("is an ordinary run if the run or the initial creatures are unknown", () => {
    const alone = { ...base, fork: { ...ONE, run: null } };
    expect(forkRequest({ base: alone, spec }, "")).toBeNull();
    expect(forkRequest({ base, spec }, "")).toBeNull();
  });

  it.each([
    [`fork=${RUN}`, ALL],
    [`fork=${RUN}&creature=${SHA}`, ONE],
    [`fork=${RUN}&creature=${SHA},${OTHER}`, { ...ALL, named: [SHA, OTHER], creatures: 2 }],
    [`fork=${RUN}&cells=2-3,9`, { ...ALL, cells: [9, 2, 3] }],
    [`fork=${RUN}&at=0`, { ...ALL, at: 0 }],
    [`initial=${SHA}`, { ...ONE, run: null }],
  ])("is named by the address %s", (text, fork) => {
    const query = new URLSearchParams(text);
    expect(sourceAddress(query)).toEqual([...query]);
    expect(addressOf({ ...base, fork })).toEqual([...query]);
  });

  it("shows errors about its creatures and its name; the form shows the others", () => {
    const own = ["from", "from.region.speed", "search.initial", "name", "generation"];
    const others = ["search.batch", "genome.max_nodes", "control", "search.generations"];
    expect([...own, ...others].filter(isForkField)).toEqual(own);
  });
});

describe("the address of a fork", () => {
  it("gives the spec of the run and the number of its elites", async () => {
    const base = await load([["fork", RUN]], EXPERIMENTS);
    expect(base.fork).toEqual(ALL);
    expect((base.spec.search as Spec).initial).toEqual([]);
  });

  it("starts from the creatures that are named, several too", async () => {
    const address = sourceAddress(new URLSearchParams(`fork=${RUN}&creature=${SHA},${OTHER}`))!;
    const base = await load(address, EXPERIMENTS);
    expect(base.fork).toEqual({ ...ALL, named: [SHA, OTHER], creatures: 2 });
    const from = { creatures: [SHA, OTHER] };
    expect(forkRequest({ base, spec: base.spec }, "")).toMatchObject({ fork: { run: RUN, from } });
  });

  it("selects the elites of its cells once each, at the newest generation at most", async () => {
    const some = async (...words: [string, string][]) =>
      (await load([["fork", RUN], ...words], EXPERIMENTS)).fork;
    expect(await some(["cells", "0-2,8-9"])).toEqual({ ...ALL, cells: [2, 9], creatures: 1 });
    expect(await some(["at", "99"])).toEqual({ ...ALL, at: 8 });
    await expect(some(["cells", "4,6-8"])).rejects.toThrow("hold no elites");
    await expect(some(["at", "0"])).rejects.toThrow("hold no elites");
    await expect(some(["at", "then"])).rejects.toThrow("“at” must be a generation; got then.");
  });

  it("selects at most as many creatures as the schema allows", () => {
    const { fields } = formOf(SEARCH.schema).fields.find(({ path }) => path === "search") as Section;
    expect(JSON.stringify(fields.find(({ path }) => path === "search.initial"))).toContain(
      `${MAX_CREATURES}`,
    );
  });

  it("gives the world of the creature if its run was no search", async () => {
    const address = [...new URLSearchParams(`fork=table&creature=${SHA}`)];
    const base = await load(address, EXPERIMENTS);
    expect(base).toMatchObject({ kind: "creature", fork: { run: null, named: [SHA] } });
    expect(base.spec).toMatchObject({ world: { width: 96 }, search: { initial: [SHA] } });
    await expect(load([["fork", "table"]], EXPERIMENTS)).rejects.toThrow("has no archive");
  });
});
