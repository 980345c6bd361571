/** Values of a grid as they are typed, and what is drawn of a sweep. */

import { describe, expect, it } from "vitest";
import type { CaseSummary, Json, Run } from "../src/api/types";
import { EMPTY, reduce } from "../src/live/store";
import { formOf, type Leaf } from "../src/view/form/fields";
import { nameOf, readSeeds, readValues, sweepable } from "../src/view/form/grid";
import { grouped, queryOf } from "../src/view/runs/filters";
import { bandsOf, caseName } from "../src/view/sweeps/bands";

const FORM = formOf({
  properties: {
    experiment: { const: "x" },
    seed: { type: "integer", default: 0 },
    world: {
      type: "object",
      properties: {
        viscosity: { type: "number", minimum: 0.001, maximum: 2 },
        width: { type: "integer", minimum: 8 },
        limit: { anyOf: [{ type: "number" }, { type: "null" }], default: null },
        fluid: { type: "boolean" },
        magic: { enum: ["capped", "fixed"] },
      },
    },
    targets: { type: "array", items: { type: "number" } },
  },
});
const SPEC = { experiment: "x", seed: 0, world: { viscosity: 0.1, width: 32 }, targets: [1] };

const fields = sweepable(FORM, SPEC);
const field = (path: string): Leaf => fields.find((one) => one.path === path)!;

describe("the fields of a grid", () => {
  it("are all values of the spec but its seed and what is fixed", () => {
    const inside = ["viscosity", "width", "limit", "fluid", "magic"].map((name) => `world.${name}`);
    expect(fields.map(({ path }) => path)).toEqual([...inside, "targets"]);
    expect(nameOf(field("world.viscosity"))).toBe("World: viscosity");
    expect(nameOf(field("targets"))).toBe("Targets");
  });

  it.each<[path: string, text: string, values: Json[]]>([
    ["world.viscosity", "0.05, 0.1,0.2", [0.05, 0.1, 0.2]],
    ["world.viscosity", " 1e-2 ;0.1 ", [0.01, 0.1]],
    ["world.viscosity", "[0.5, 1]", [0.5, 1]],
    ["world.limit", "none, 0.5", [null, 0.5]],
    ["world.fluid", "on off", [true, false]],
    ["world.magic", "capped fixed", ["capped", "fixed"]],
    ["targets", "[[1, 2], [3]]", [[1, 2], [3]]],
  ])("read %s from %j", (path, text, values) => {
    expect(readValues(field(path), text)).toEqual({ values, problem: null });
  });

  it.each([
    ["world.viscosity", "", "Needs values"],
    ["world.viscosity", "0.1, thick", "Needs a number, got “thick”"],
    ["world.viscosity", "0.1, 3", "Needs at most 2"],
    ["world.viscosity", "0.1, 0.10", "Has 0.1 more than once"],
    ["world.width", "32, 32.5", "Needs a whole number"],
    ["world.fluid", "on, maybe", "Needs on or off"],
    ["world.magic", "fixd", "Needs any of capped, fixed, got “fixd”"],
    ["world.viscosity", "[0.1", "Needs a JSON list"],
    ["targets", "1, 2", "Needs a JSON list"],
  ])("say what is wrong with %s as %j", (path, text, words) => {
    expect(readValues(field(path), text).problem).toContain(words);
  });

  it.each([
    ["3", 3, true],
    ["1000", 1000, true],
    ["0", 1, false],
    ["1001", 1, false],
    ["2.5", 1, false],
    ["", 1, false],
  ])("read %j as so many seeds", (text, seeds, right) => {
    const found = readSeeds(text);
    expect([found.seeds, found.problem === null]).toEqual([seeds, right]);
  });
});

const none = { median: [null], low: [null], high: [null], min: [null], max: [null] };

function summaryOf(generation: number[], median: number[]): CaseSummary {
  const band = { median, low: median.map((v) => v - 1), high: median.map((v) => v + 1) };
  const qd_score = { ...band, min: band.low, max: band.high };
  const members = [{ run: "a", seed: 0, status: "running" as const, generation: 2, generations: 3 }];
  const empty = generation.length > 0 ? none : { median: [], low: [], high: [], min: [], max: [] };
  const runs = generation.map(() => 1);
  return { values: {}, members, generation, runs, qd_score, coverage: empty, best: empty, finals: {} };
}

describe("the bands of a sweep", () => {
  const shown = (summary: CaseSummary, place: number) => ({
    summary,
    place,
    name: `case ${place}`,
    colour: `--series-${place}`,
    dash: undefined,
  });

  it("lie between the quartiles of each case, with the median in them", () => {
    const cases = [summaryOf([1, 2], [5, 6]), summaryOf([1], [7])].map(shown);
    const [plot, ...others] = bandsOf(cases, null);
    expect(others).toEqual([]);
    expect(plot!.series.map(({ y }) => y)).toEqual([[6, 7], [4, 5], [5, 6], [8], [6], [7]]);
    expect(plot!.bands!.map(({ high, low }) => [high, low])).toEqual([
      [0, 1],
      [3, 4],
    ]);
    expect(plot!.series.filter(({ edge }) => !edge).map(({ name }) => name)).toEqual(["case 0", "case 1"]);
  });

  it("have their own runs behind them where those are asked for", () => {
    const line = { qd_score: [4, 5], coverage: [null, null], best: [null, null] };
    const lines = [
      { run: "a", ...line },
      { run: "of another case", ...line },
    ];
    const [plot] = bandsOf([shown(summaryOf([1, 2], [5, 6]), 0)], { generation: [1, 2], lines });
    expect(plot!.series.map(({ faint = false }) => faint)).toEqual([true, false, false, false]);
    expect(plot!.bands).toEqual([{ high: 1, low: 2, colour: "--series-0" }]);
  });

  it("are named by the last words of their fields, unless those are the same", () => {
    expect(caseName({ "world.viscosity": 0.05, "body.nodes": 16 })).toBe("viscosity 0.05, nodes 16");
    const seeds = { "body.seed": 1, "archive.seed": 2 };
    expect(caseName(seeds)).toBe("body.seed 1, archive.seed 2");
    expect(caseName({})).toBe("all runs");
  });
});

describe("what is heard of a sweep", () => {
  it("raises its news, and those of lists where it began or was steered", () => {
    const run = { id: "r", sweep: "s", spec: {}, status: "running" } as unknown as Run;
    const once = reduce(EMPTY, { type: "run", run });
    expect(once.swept.get("s")).toBe(1);
    const again = reduce(once, { type: "run", run: { ...run, generation: 2 } });
    expect([again.swept.get("s"), again.news]).toEqual([2, once.news]);
    const steered = reduce(again, { type: "sweep", sweep: "s" });
    expect([steered.swept.get("s"), steered.news]).toEqual([3, again.news + 1]);
  });
});

describe("the list of runs", () => {
  it("has runs of sweeps stand as one as long as nothing is asked of it", () => {
    expect(grouped(queryOf(new URLSearchParams()))).toBe(true);
    expect(grouped(queryOf(new URLSearchParams("q=thick")))).toBe(false);
    const id = "01234567-89ab-cdef-0123-456789abcdef";
    expect(queryOf(new URLSearchParams(`sweep=${id}`))).toEqual({ sweep: id });
    expect(queryOf(new URLSearchParams("sweep=x"))).toEqual({});
  });
});
