import { describe, expect, it } from "vitest";
import { NO_CURVES } from "../../store/curves";
import type { Run } from "../../api/types";
import { ticksOf } from "../../charts/plot/scale";
import { pictureBox } from "./FoldsCard";
import { learningCurveOf } from "./LearningRun";

describe("a curve", () => {
  const curves = (summary: Record<string, number[]>) => ({ ...NO_CURVES, generation: [1, 2, 3], summary });
  const run = (experiment: string) => ({ experiment, generations: 3 }) as unknown as Run;

  it("labels ticks differently, also if values hardly differ", () => {
    const { y } = learningCurveOf(run("refinement"), curves({ fitness: [2.956, 3.01, 3.018] }));
    const names = ticksOf(y.scale, 8).map(y.format);
    expect(names.length).toBeGreaterThan(3);
    expect(new Set(names).size).toBe(names.length);
  });

  it("has a line for each picture that a filament folds into", () => {
    const losses = {
      "loss.3": [0.1, 0.05, 0.02],
      "loss.7": [0.1, 0.04, 0.01],
      loss: [0.1, 0.045, 0.015],
    };
    const { lines } = learningCurveOf(run("folding"), curves(losses));
    expect(lines.map(({ name }) => name)).toEqual(["3", "7"]);
    expect(lines[1]!.points.map(({ y }) => y)).toEqual([0.1, 0.04, 0.01]);
  });
});

describe("the picture under a filament", () => {
  it("is in the middle of the world and has the size of the spec", () => {
    const target = { name: "3", width: 8, height: 16, size: 32, pixels: "" };
    expect(pictureBox(target, [48, 64])).toEqual({ left: 15.5, top: 47.5, width: 16, height: 32 });
  });
});
