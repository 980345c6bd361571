/** What a run has come to, in a few figures. */

import type { Run } from "../api/types";
import { bytes, count, number, percent } from "../ui/format";

export type Figure = [name: string, value: string];

const told = (run: Run, name: string) => {
  const value = run.summary?.[name];
  return typeof value === "number" ? value : null;
};

/** Behind progress and time, on the page of a run. */
export function figuresOf(run: Run): Figure[] {
  switch (run.experiment) {
    case "gaits":
      return [
        ["Points", count(told(run, "points") ?? run.evaluations)],
        ["With warnings", count(told(run, "warned") ?? 0)],
        ["Failed", count(told(run, "failed") ?? run.diverged)],
      ];
    case "folding":
      return [["Mean loss", number(told(run, "loss"))]];
    case "refinement":
      return [
        ["Fitness before", number(told(run, "before"))],
        ["Fitness", number(told(run, "fitness"))],
      ];
    case "scaling":
      return [
        ["Exponent", number(told(run, "exponent"))],
        ["All-pairs exponent", number(told(run, "exponent_all_pairs"))],
        ["Peak memory", bytesOf(told(run, "peak_memory_bytes"))],
      ];
    default:
      return [
        ["QD score", number(run.qd_score)],
        ["Coverage", percent(run.coverage)],
        ["Best fitness", number(run.best)],
        ["Diverged", count(run.diverged)],
      ];
  }
}

/** The one figure that stands for a run in a list. */
export function keyFigureOf(run: Run): Figure {
  const figures = Object.fromEntries(figuresOf(run));
  switch (run.experiment) {
    case "gaits":
      return ["points", figures["Points"]!];
    case "scaling":
      // The exponent is of many nodes only, which small measurements do not have.
      if (told(run, "exponent") === null) return ["peak memory", figures["Peak memory"]!];
      return ["exponent", figures["Exponent"]!];
    case "folding":
      return ["mean loss", figures["Mean loss"]!];
    case "refinement":
      return ["fitness", figures["Fitness"]!];
    case "neuroevolution":
      return ["best fitness", figures["Best fitness"]!];
    default:
      return ["QD score", figures["QD score"]!];
  }
}

function bytesOf(value: number | null): string {
  return value === null ? number(value) : bytes(value);
}

const GENERATIONS: Record<string, string> = {
  gaits: "Strokes",
  scaling: "Sizes",
  folding: "Updates",
  refinement: "Steps",
};

/** What a generation of a run is called. */
export const generationsOf = (run: Run) => GENERATIONS[run.experiment] ?? "Generation";
