import { beforeEach, describe, expect, it, vi } from "vitest";
import type { DrawnBody, Estimate } from "../api/types";
import { type Draft, addressOf, discardDraft, loadDraft, saveDraft } from "../store/draft";
import { EXPERIMENTS, experiment } from "./form/form.fixture";
import { load, baseOfPreset, titleOfBase } from "./sources";
import { branchesOf, dotsOf, linesOf, periodicShifts, viewOf } from "./BodyDrawing";
import { timeText, estimateBasis, roughDuration, waitText } from "./Costs";

describe("a draft", () => {
  const base = baseOfPreset(experiment("gaits").presets[0]!, experiment("gaits"));
  const work: Draft = { base, spec: { ...base.spec, period: 77 } };
  const stored = new Map<string, string>();
  beforeEach(() => {
    stored.clear();
    vi.stubGlobal("sessionStorage", {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, text: string) => void stored.set(key, text),
      removeItem: (key: string) => void stored.delete(key),
    });
  });

  it("is restored until it is discarded", () => {
    saveDraft(work);
    expect(loadDraft(null)).toEqual(work);
    discardDraft();
    expect(loadDraft(null)).toBeNull();
  });

  it("is ignored if the address names another source", () => {
    saveDraft(work);
    expect(loadDraft([["preset", "gaits/demo"]])).toEqual(work);
    expect(loadDraft([["preset", "gaits/paper"]])).toBeNull();
    expect(loadDraft([["from", "a run"]])).toBeNull();
  });

  it("is ignored if it cannot be read", () => {
    stored.set("microcosmos:draft", "{");
    expect(loadDraft(null)).toBeNull();
    stored.set("microcosmos:draft", "{}");
    expect(loadDraft(null)).toBeNull();
  });

  it("has an address if its source has a name", async () => {
    expect(addressOf(base)).toEqual([["preset", "gaits/demo"]]);
    expect(addressOf({ kind: "run", name: "a" })).toEqual([["from", "a"]]);
    expect(addressOf({ kind: "pasted", name: "spec.json" })).toBeNull();
    expect(addressOf({ kind: "run", name: "a", fromDocument: true })).toBeNull();
    expect(await load([["preset", "gaits/demo"]], EXPERIMENTS)).toEqual(base);
    await expect(load([["preset", "gaits/none"]], EXPERIMENTS)).rejects.toThrow(
      /gaits\/paper.*got gaits\/none/,
    );
    expect(titleOfBase(base)).toBe("preset “demo”");
  });
});

describe("costs in words", () => {
  const queue = { runs_ahead: 0, workers: 1, idle_workers: 1 };
  const speed = { device: "a CPU", runs: 3, cell_steps_per_second: 1e6, low: 600, high: 700 };
  const estimate = (changes: object) => ({ seconds: 650, speed, queue, ...changes }) as Estimate;

  it.each([
    [3, "10 s"],
    [42, "40 s"],
    [700, "12 min"],
    [9000, "2.5 h"],
    [200000, "2 days"],
    [1e9, "more than a year"],
  ])("write %f s as %s", (seconds, text) => expect(roughDuration(seconds)).toBe(text));

  it("name the basis of a time, and a wide range", () => {
    expect(timeText(estimate({}))).toBe("about 11 min");
    expect(timeText(estimate({ seconds: 2 }))).toBe("a few seconds");
    expect(estimateBasis(estimate({}))).toBe("on a CPU, based on 3 earlier runs");
    expect(estimateBasis(estimate({ speed: { ...speed, runs: 1, high: 1300 } }))).toBe(
      "on a CPU, based on 1 earlier run; range 10 min to 22 min",
    );
    expect(timeText(estimate({ seconds: null }))).toBeNull();
    expect(estimateBasis(estimate({ speed: null }))).toMatch(/^unknown until this server/);
  });

  it.each([
    [{ workers: 0 }, /No worker/],
    [{ runs_ahead: 2 }, /2 queued runs are ahead/],
    [{}, /immediately/],
    [{ idle_workers: 0 }, /when a worker is free/],
  ])("name the reason to wait with %j", (changes, words) =>
    expect(waitText(estimate({ queue: { ...queue, ...changes } }))).toMatch(words),
  );
});

const pairs = (text: string) => text.split(", ").map((pair) => pair.split(" ").map(Number));

describe("the drawing of a body", () => {
  const fork: DrawnBody = {
    name: "fork",
    nodes: 4,
    positions: pairs("0 0, 2 0, 4 1, 4 -1"),
    edges: pairs("0 1, 1 2, 1 3"),
    whole: true,
  };

  it("has a line for every edge, a dot at every node, and a mark at every branch", () => {
    expect(linesOf(fork)).toBe("M0 0L2 0M2 0L4 1M2 0L4 -1");
    expect(dotsOf(fork, 1)).toBe("M0 0h0M2 0h0M4 1h0M4 -1h0");
    expect(branchesOf(fork)).toBe("M2 0h0");
  });

  it("has no dots if they would touch or nodes are left out", () => {
    expect(dotsOf(fork, 2.1)).toBe("");
    expect(dotsOf({ ...fork, nodes: 9 }, 1)).toBe("");
  });

  it("leaves out the water around many small bodies, but never a part of a body", () => {
    const world = { width: 48, height: 64, pictures: [], picture_size: 0, solid: [] };
    const at = (x: number) => ({ ...fork, positions: [[x, 32]] });
    const many = (x: number) => ({ ...world, bodies: [...Array(11).fill(at(24)), at(x)] });
    const whole = { x: 0, y: 0, width: 48, height: 64 };
    expect(viewOf({ ...world, bodies: [at(24)] })).toMatchObject(whole);
    expect(viewOf(many(32.5))).toEqual({ x: 13, y: 21, width: 22, height: 22, side: 22 });
    expect(viewOf(many(47))).toMatchObject(whole);
  });

  it("is repeated on the other side of its periodic world", () => {
    const within = { ...fork, positions: pairs("1 1, 3 3") };
    expect(periodicShifts(within, 10, 10).map(String)).toEqual(["0,0"]);
    const across = { ...fork, positions: pairs("8 1, 12 -1") };
    expect(periodicShifts(across, 10, 10).map(String).sort()).toEqual(["-10,0", "-10,10", "0,0", "0,10"]);
  });
});
