import { describe, expect, it } from "vitest";
import type { LogEntry, Run } from "../api/types";
import { endReasonOf, figuresOf, keyFigureOf } from "./figures";
import { activityOf, elapsedOf } from "./RunStatus";
import { atLeast, textOf } from "./LogCard";

describe("a log", () => {
  const entry = (id: number, level: LogEntry["level"], text: string): LogEntry => ({
    id,
    at: `2026-01-01T00:00:0${id}Z`,
    level,
    attempt: 1,
    text,
    details: null,
  });
  const entries = [entry(1, "info", "Begins."), entry(2, "warning", "Full."), entry(3, "error", "Ended.")];

  it("shows a level and those above it", () => {
    expect(atLeast(entries, "info")).toEqual(entries);
    expect(atLeast(entries, "warning").map(({ id }) => id)).toEqual([2, 3]);
    expect(atLeast(entries, "error").map(({ id }) => id)).toEqual([3]);
  });

  it("is copied as lines, oldest first", () => {
    expect(textOf(entries.slice(0, 2))).toBe(
      "2026-01-01T00:00:01Z info [attempt 1] Begins.\n2026-01-01T00:00:02Z warning [attempt 1] Full.",
    );
  });

  it("is copied with the traceback of an error", () => {
    const failed = { ...entries[2]!, details: "Traceback:\n  File x" };
    expect(textOf([failed])).toMatch(/Ended\.\nTraceback:\n  File x$/);
  });
});

describe("the activity of a run without figures", () => {
  const run = {
    status: "running",
    generation: 0,
    device: "cpu, a processor",
    created_at: "2026-01-01T00:00:00Z",
    started_at: "2026-01-01T00:01:00Z",
  } as Run;

  it("is shown with its duration", () => {
    expect(activityOf(run)).toContain("up to a minute on a CPU");
    expect(activityOf({ ...run, device: null })).toContain("preparing");
    expect(activityOf({ ...run, generation: 1 })).toBeNull();
    expect(activityOf({ ...run, status: "finished" })).toBeNull();
    const queued = { ...run, status: "queued", queued_at: "2026-01-01T00:01:30Z" } as Run;
    expect(activityOf({ ...queued, waiting_reason: "All workers are busy." })).toBe("All workers are busy.");
    const now = Date.parse("2026-01-01T00:01:42Z");
    expect(elapsedOf(run, now)).toBe("42 s");
    expect(elapsedOf(queued, now)).toBe("12 s");
  });
});

describe("the reason why a run ended", () => {
  const run = { generations: 50, spec: { search: { stop: { evaluations: 5000 } } } } as unknown as Run;
  it.each([
    [null, "Completed all 50 generations."],
    [{ "ended.evaluations": 12 }, "Ended after generation 12: it used its budget of 5,000 evaluations."],
    [{ "ended.device_hours": 3 }, "Ended after generation 3: it met its limit of device hours."],
  ])("%j becomes %j", (summary, sentence) => {
    expect(endReasonOf({ ...run, summary })).toBe(sentence);
  });
});

describe("a search without an elite", () => {
  it("says so at its end, and has no best fitness", () => {
    const scores = { qd_score: 0, coverage: 0, best: null, infeasible: 16, evaluations: 16 };
    const run = {
      experiment: "quality-diversity",
      generations: 2,
      summary: null,
      ...scores,
    } as unknown as Run;
    expect(endReasonOf(run)).toBe(
      "Completed all 2 generations. No elite: 16 of 16 evaluations were infeasible.",
    );
    expect(Object.fromEntries(figuresOf(run))).toMatchObject({ "Best fitness": "–" });
  });
});

describe("the variety of a search", () => {
  const run = { experiment: "quality-diversity", summary: null } as unknown as Run;

  it("is shown once the run has measured it", () => {
    expect(Object.fromEntries(figuresOf(run))).not.toHaveProperty("Motion distance");
    const summary = { motion_distance: 0.1234, nearest_motion: 0.05, kinds: 12 };
    expect(figuresOf({ ...run, summary }).slice(-2)).toEqual([
      ["Motion distance", "0.123 body lengths"],
      ["Kinds of motion", "12"],
    ]);
  });
});

describe("the figures of a search whose elites were re-evaluated", () => {
  const scores = { qd_score: 67.1, coverage: 0.605, best: 0.6, infeasible: 3, summary: null };
  const run = { experiment: "quality-diversity", ...scores } as unknown as Run;
  const corrected = { corrected_qd_score: 55.9, corrected_coverage: 0.5, hit_rate: 0.71 };

  it("have the corrected ones beside those as found", () => {
    expect(keyFigureOf(run)).toEqual(["QD score", "67.1"]);
    expect(Object.fromEntries(figuresOf(run))).not.toHaveProperty("Hit rate");
    expect(keyFigureOf({ ...run, ...corrected })).toEqual(["QD score", "67.1 (corrected 55.9)"]);
    expect(Object.fromEntries(figuresOf({ ...run, ...corrected }))).toMatchObject({
      "QD score": "67.1",
      "Corrected QD score": "55.9",
      "Corrected coverage": "50 %",
      "Hit rate": "71 %",
    });
  });
});
