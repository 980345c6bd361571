/** Key figures of a run. */

import type { Run } from "../api/types";
import { bytes, count, number, percent } from "../ui/format";
import { text } from "./text";

export type Figure = [name: string, value: string];

const told = (run: Run, name: string) => {
  const value = run.summary?.[name];
  return typeof value === "number" ? value : null;
};

/** The figures on the page of a run. */
export function figuresOf(run: Run): Figure[] {
  switch (run.experiment) {
    case "gaits":
      return [
        [text.points, count(told(run, "points") ?? run.evaluations)],
        [text.withWarnings, count(told(run, "warned") ?? 0)],
        [text.failed, count(told(run, "failed") ?? run.diverged)],
      ];
    case "folding":
      return [[text.meanLoss, number(told(run, "loss"))]];
    case "refinement":
      return [
        [text.fitnessBefore, number(told(run, "before"))],
        [text.fitness, number(told(run, "fitness"))],
      ];
    case "scaling":
      return [
        [text.exponent, number(told(run, "exponent"))],
        [text.allPairsExponent, number(told(run, "exponent_all_pairs"))],
        [text.peakMemory, bytesOf(told(run, "peak_memory_bytes"))],
      ];
    default:
      return [
        [text.qdScore, number(run.qd_score)],
        [text.coverage, percent(run.coverage)],
        [text.bestFitness, number(run.best)],
        [text.diverged, count(run.diverged)],
      ];
  }
}

/** The figure of a run in a list. */
export function keyFigureOf(run: Run): Figure {
  const figures = Object.fromEntries(figuresOf(run));
  switch (run.experiment) {
    case "gaits":
      return [text.points.toLowerCase(), figures[text.points]!];
    case "scaling":
      // The exponent is of many nodes only, which small measurements do not have.
      if (told(run, "exponent") === null) return [text.peakMemory.toLowerCase(), figures[text.peakMemory]!];
      return [text.exponent.toLowerCase(), figures[text.exponent]!];
    case "folding":
      return [text.meanLoss.toLowerCase(), figures[text.meanLoss]!];
    case "refinement":
      return [text.fitness.toLowerCase(), figures[text.fitness]!];
    case "neuroevolution":
      return [text.bestFitness.toLowerCase(), figures[text.bestFitness]!];
    default:
      return [text.qdScore, figures[text.qdScore]!];
  }
}

function bytesOf(value: number | null): string {
  return value === null ? number(value) : bytes(value);
}

const GENERATIONS: Record<string, string> = {
  gaits: text.strokes,
  scaling: text.sizes,
  folding: text.updates,
  refinement: text.steps,
};

/** The name of a generation of a run. */
export const generationsOf = (run: Run) => GENERATIONS[run.experiment] ?? text.generation;
