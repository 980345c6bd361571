import { beforeEach, describe, expect, inject, it, vi } from "vitest";
import type { Creature, DrawnBody, Estimate, Json, Spec } from "../src/api/types";
import { type Work, addressOf, discard, draftFor, keep } from "../src/live/draft";
import { load, ofFound, ofPreset, titleOfBase, whole } from "../src/pages/new/sources";
import { branchesOf, dotsOf, linesOf, tilesOf } from "../src/view/bodyPaths";
import { about, basis, rough, wait } from "../src/view/costs";
import { completed } from "../src/view/form/completing";
import { countWithin, changedPaths, equalPreset } from "../src/view/form/differences";
import { complaints } from "../src/view/form/document";
import { type NumberField, type Section, formOf } from "../src/view/form/fields";
import { rangeText } from "../src/view/form/inputs";
import { readDocument, readText } from "../src/view/form/reading";

const EXPERIMENTS = inject("experiments");
const PRESETS = EXPERIMENTS.flatMap((one) =>
  one.presets.map((preset) => [`${one.experiment}/${preset.name}`, one, preset] as const),
);
const experiment = (name: string) => EXPERIMENTS.find((one) => one.experiment === name)!;

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

describe("what is pasted or dropped", () => {
  it("is a spec, a run, or a creature", () => {
    const spec = { experiment: "gaits" };
    expect(readText(JSON.stringify(spec))).toEqual({ kind: "spec", spec });
    expect(readText(JSON.stringify({ id: "a run", spec }))).toEqual({ kind: "run", id: "a run", spec });
    const file = creature({ encoding: "cppn", control: { period: 50 } });
    expect(readDocument(file as unknown as Json)).toMatchObject({ kind: "creature", creature: file });
  });

  it.each([
    ["{", /this is no JSON/],
    ["[1]", /got a list/],
    ["7", /got number 7/],
    ["{}", /“experiment” must name the experiment; got nothing/],
    ['{"spec": {"experiment": 3}}', /“spec.experiment” .* got number 3/],
    ["\u0089HDF", /HDF5/],
    ["\ufffdHDF", /HDF5/],
  ])("is refused as %j, told what was needed", (text, words) => {
    expect(() => readText(text)).toThrow(words);
    expect(() => readText(text)).toThrow(/a spec, a run as the API gives it, or a creature file/);
  });
});

describe("a creature", () => {
  it("gives its world, body, coupling, controller, room and task to a search", () => {
    const file = creature({ encoding: "cppn", control: { period: 50 } }, { measured: { room: [30, 80] } });
    const found = readDocument(file as unknown as Json);
    const spec = whole(found.spec, EXPERIMENTS) as { [part: string]: Spec };
    expect(spec.experiment).toBe("quality-diversity");
    expect(spec.world).toMatchObject({ width: 96, height: 64, viscosity: 0.2, fluid: true });
    expect(spec.world).not.toHaveProperty("coupling");
    expect(spec.coupling).toMatchObject({ theta_feedback: 0, force_factor: 2 });
    expect(spec.control).toMatchObject({ encoding: "cppn", period: 50, angle_scale: 0.1 });
    expect(spec.genome).toMatchObject({ max_nodes: 30, max_connections: 80, weight_rate: 0.6 });
    expect(spec.task).toMatchObject({ steps: 70 });
    expect(complaints(formOf(experiment("quality-diversity").schema), spec)).toEqual([]);
  });

  it("whose genes are numbers is searched by what varies numbers", () => {
    const { spec } = readDocument(creature({ encoding: "direct", control: {} }) as unknown as Json);
    const full = whole(spec, EXPERIMENTS) as { search: { emitters: Spec[] }; control: Spec };
    expect(full.control.encoding).toBe("direct");
    expect(full.search.emitters).toEqual([{ operator: "iso+line", share: 1, iso: 0.02, line: 0.2 }]);
  });

  it("with a gait by hand, or with a fold, gives an experiment of its kind", () => {
    const gait = { encoding: "gait", swimmer: "ray", period: 300, ramp: 2 };
    const sweep = readDocument(creature(gait) as unknown as Json).spec;
    expect(sweep).toMatchObject({ experiment: "gaits", swimmers: ["ray"], period: 300, viscosities: [0.2] });
    const fold = readDocument(creature({ encoding: "fold", control: { lengths: "raw" } }) as unknown as Json);
    expect(fold.spec).toMatchObject({ experiment: "folding", steps: 70, size: 42 });
    expect(whole(fold.spec, EXPERIMENTS).control).toEqual({ encoding: "fold", lengths: "raw" });
  });

  it("is refined where that was chosen", () => {
    const file = creature({ encoding: "cppn", control: {} }) as unknown as Json;
    const base = ofFound(readDocument(file, true), "", EXPERIMENTS);
    expect(base).toMatchObject({
      kind: "creature",
      foreign: true,
      spec: { experiment: "refinement", creature: file },
    });
    expect(base.spec.steps).toBe(20);
  });
});

describe("a spec", () => {
  it.each(PRESETS)("of %s needs nothing, and from its name alone gets defaults", (_, one, preset) => {
    expect(completed(one.schema, preset.spec)).toEqual(preset.spec);
    const bare = completed(one.schema, { experiment: one.experiment });
    expect(complaints(formOf(one.schema), bare)).toEqual([]);
  });

  it("keeps what it says in parts of which it says not all", () => {
    const { schema } = experiment("quality-diversity");
    const given = { experiment: "quality-diversity", body: { nodes: 12 }, world: { steric: { limit: 0.2 } } };
    const full = completed(schema, given) as { [part: string]: Spec };
    expect(full.body).toEqual({ builder: "chain", nodes: 12, spacing: 1, stretch: 1, shear: 1, bend: 1 });
    expect(full.world!.steric).toEqual({ strength: 4, limit: 0.2, smoothing: "gaussian" });
    const odd = completed(schema, { ...given, surprise: 1, body: { builder: "dragon" } });
    expect(odd).toMatchObject({ surprise: 1, body: { builder: "dragon" } });
  });

  it("of an unknown experiment is refused with those that there are", () => {
    expect(() => whole({ experiment: "astrology" }, EXPERIMENTS)).toThrow(/quality-diversity.*got astrology/);
  });
});

describe("differences", () => {
  it("are paths of values, and of parts and lists that are made otherwise", () => {
    const a = { seed: 0, body: { builder: "chain", nodes: 3 }, rows: [{ x: 1 }, { x: 2 }], list: [1, 2] };
    expect(changedPaths(a, structuredClone(a))).toEqual([]);
    const b = { seed: 1, body: { builder: "worm" }, rows: [{ x: 1 }, { x: 3 }], list: [1, 3] };
    expect(changedPaths(a, b)).toEqual(["seed", "body", "rows.1.x", "list"]);
    expect(changedPaths({ part: null }, { part: { x: 1 } })).toEqual(["part"]);
    expect(changedPaths({ rows: [] }, { rows: [{ x: 1 }] })).toEqual(["rows"]);
  });

  it("are counted within a part, not within one whose name begins like it", () => {
    expect(countWithin(["world", "world.width", "worldly.x"], "world")).toBe(2);
  });

  it.each(PRESETS)("find %s by its spec, whatever its seed", (_, __, preset) => {
    expect(equalPreset(preset.spec, EXPERIMENTS)?.spec).toEqual(preset.spec);
    const seeded = "seed" in preset.spec ? { ...preset.spec, seed: 99 } : preset.spec;
    expect(equalPreset(seeded, EXPERIMENTS)?.spec).toEqual(preset.spec);
    expect(equalPreset({ ...preset.spec, steps: -1, width: -1 }, EXPERIMENTS)).toBeNull();
  });
});

describe("a draft", () => {
  const base = ofPreset(experiment("gaits").presets[0]!, experiment("gaits"));
  const work: Work = { base, spec: { ...base.spec, period: 77 } };
  const stored = new Map<string, string>();
  beforeEach(() => {
    stored.clear();
    vi.stubGlobal("sessionStorage", {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, text: string) => void stored.set(key, text),
      removeItem: (key: string) => void stored.delete(key),
    });
  });

  it("is there again until it is discarded", () => {
    keep(work);
    expect(draftFor(null)).toEqual(work);
    discard();
    expect(draftFor(null)).toBeNull();
  });

  it("gives way where the address names something else", () => {
    keep(work);
    expect(draftFor([["preset", "gaits/demo"]])).toEqual(work);
    expect(draftFor([["preset", "gaits/paper"]])).toBeNull();
    expect(draftFor([["from", "a run"]])).toBeNull();
  });

  it("that cannot be read is none", () => {
    stored.set("microcosmos:draft", "{");
    expect(draftFor(null)).toBeNull();
    stored.set("microcosmos:draft", "{}");
    expect(draftFor(null)).toBeNull();
  });

  it("has an address where it was begun from something with a name", async () => {
    expect(addressOf(base)).toEqual([["preset", "gaits/demo"]]);
    expect(addressOf({ kind: "run", name: "a" })).toEqual([["from", "a"]]);
    expect(addressOf({ kind: "pasted", name: "spec.json" })).toBeNull();
    expect(addressOf({ kind: "run", name: "a", foreign: true })).toBeNull();
    expect(await load([["preset", "gaits/demo"]], EXPERIMENTS)).toEqual(base);
    await expect(load([["preset", "gaits/none"]], EXPERIMENTS)).rejects.toThrow(
      /gaits\/paper.*got gaits\/none/,
    );
    expect(titleOfBase(base)).toBe("preset “demo”");
  });
});

describe("costs in words", () => {
  const queue = { waiting: 0, workers: 1, free: 1 };
  const pace = { device: "a CPU", runs: 3, cell_steps_per_second: 1e6, low: 600, high: 700 };
  const estimate = (changes: object) => ({ seconds: 650, pace, queue, ...changes }) as Estimate;

  it.each([
    [3, "10 s"],
    [42, "40 s"],
    [700, "12 min"],
    [9000, "2.5 h"],
    [200000, "2 days"],
    [1e9, "more than a year"],
  ])("has %f s as %s", (seconds, text) => expect(rough(seconds)).toBe(text));

  it("tells what a time rests on, and a range where it is wide", () => {
    expect(about(estimate({}))).toBe("about 11 min");
    expect(about(estimate({ seconds: 2 }))).toBe("a few seconds");
    expect(basis(estimate({}))).toBe("on a CPU, judged by 3 earlier runs");
    expect(basis(estimate({ pace: { ...pace, runs: 1, high: 1300 } }))).toBe(
      "on a CPU, judged by 1 earlier run; at their paces 10 min to 22 min",
    );
    expect(about(estimate({ seconds: null }))).toBeNull();
    expect(basis(estimate({ pace: null }))).toMatch(/^unknown until a first run/);
  });

  it.each([
    [{ workers: 0 }, /No worker/],
    [{ waiting: 2 }, /2 queued runs go/],
    [{}, /at once/],
    [{ free: 0 }, /when a worker is free/],
  ])("says what a run waits for with %j", (changes, words) =>
    expect(wait(estimate({ queue: { ...queue, ...changes } }))).toMatch(words),
  );
});

describe("units and ranges", () => {
  it("of a number beside the word that decides them, or of the part around it", () => {
    const number = (description: string, more: Spec = {}) => ({ type: "number", description, ...more });
    const form = formOf({
      properties: {
        kind: { type: "string", enum: ["a", "b"] },
        low: number("Low.", { unit_of: "kind", units: { a: "rad", b: "" } }),
        angle: { type: "object", unit: "rad", properties: { high: number("High.") } },
      },
    });
    const [, low, angle] = form.fields as [unknown, NumberField, Section];
    expect(low.unitBy).toEqual({ path: "kind", units: { a: "rad", b: "" } });
    expect(angle.fields[0]).toMatchObject({ path: "angle.high", unit: "rad" });
  });

  it.each([
    [{ low: 16, high: 2048 }, "16 to 2,048"],
    [{ low: 0, lowOpen: true, high: 1 }, "more than 0, at most 1"],
    [{ low: 1, high: 1e6 }, "1 to 1,000,000"],
    [{ low: 1 }, "at least 1"],
    [{}, ""],
  ])("%j is %s", (range, text) => expect(rangeText(range)).toBe(text));

  it("closes parts that are seldom changed", () => {
    const form = formOf(experiment("quality-diversity").schema);
    const seldom = form.fields.filter((field) => "seldom" in field).map(({ path }) => path);
    expect(seldom).toEqual(["coupling", "genome"]);
  });
});

describe("a body that is drawn", () => {
  const fork: DrawnBody = {
    name: "fork",
    nodes: 4,
    positions: [
      [0, 0],
      [2, 0],
      [4, 1],
      [4, -1],
    ],
    edges: [
      [0, 1],
      [1, 2],
      [1, 3],
    ],
    whole: true,
  };

  it("has a line for every edge, a dot at every node, and marks where it branches", () => {
    expect(linesOf(fork)).toBe("M0 0L2 0M2 0L4 1M2 0L4 -1");
    expect(dotsOf(fork, 1)).toBe("M0 0h0M2 0h0M4 1h0M4 -1h0");
    expect(branchesOf(fork)).toBe("M2 0h0");
  });

  it("has no dots where they would touch, or where nodes were left out", () => {
    expect(dotsOf(fork, 2.1)).toBe("");
    expect(dotsOf({ ...fork, nodes: 9 }, 1)).toBe("");
  });

  it("is seen again on the other side of its periodic world", () => {
    const within = {
      ...fork,
      positions: [
        [1, 1],
        [3, 3],
      ],
    };
    expect(tilesOf(within, 10, 10).map(String)).toEqual(["0,0"]);
    const across = {
      ...fork,
      positions: [
        [8, 1],
        [12, -1],
      ],
    };
    expect(tilesOf(across, 10, 10).map(String).sort()).toEqual(["-10,0", "-10,10", "0,0", "0,10"]);
  });
});
