/** Key figures of a run, and the reason why it ended. */

import type { Run, Json, Spec } from "../api/types";
import { DASH, bytes, count, number, percent } from "../ui/format";
import { endOf } from "../store/figureNames";
import { text } from "./text";

export type Figure = [name: string, value: string];

type Format = (value: number | null | undefined, digits?: number) => string;

/** The scores of an archive, with their titles and formats. */
export const SCORES: [name: "qd_score" | "coverage" | "best", title: string, format: Format][] = [
  ["qd_score", text.qdScore, number],
  ["coverage", text.coverage, percent],
  ["best", text.bestFitness, number],
];

type Corrected = "corrected_qd_score" | "corrected_coverage" | "hit_rate";

/** Figures after re-evaluation of the elites, which only some runs have. */
export const CORRECTED: [name: Corrected, title: string, format: Format][] = [
  ["corrected_qd_score", text.correctedQdScore, number],
  ["corrected_coverage", text.correctedCoverage, percent],
  ["hit_rate", text.hitRate, percent],
];

export const hasCorrected = (run: Run) => (run.corrected_qd_score ?? null) !== null;

const correctedOf = (run: Run): Figure[] =>
  hasCorrected(run) ? CORRECTED.map(([name, title, format]): Figure => [title, format(run[name])]) : [];

const summaryOf = (run: Run, name: string) => {
  const value = run.summary?.[name];
  return typeof value === "number" ? value : null;
};

export function figuresOf(run: Run): Figure[] {
  const value = (name: string) => summaryOf(run, name);
  const memory = value("peak_memory_bytes");
  switch (run.experiment) {
    case "gaits":
      return [
        [text.points, count(value("points") ?? run.evaluations)],
        [text.withWarnings, count(value("warned") ?? 0)],
        [text.failed, count(value("failed") ?? run.infeasible)],
      ];
    case "folding":
      return [[text.meanLoss, number(value("loss"))]];
    case "refinement":
      return [
        [text.fitnessBefore, number(value("before"))],
        [text.fitness, number(value("fitness"))],
      ];
    case "scaling":
      return [
        [text.exponent, number(value("exponent"))],
        [text.allPairsExponent, number(value("exponent_all_pairs"))],
        [text.peakMemory, memory === null ? DASH : bytes(memory)],
      ];
    default:
      return [
        ...SCORES.map(([name, title, format]): Figure => [title, format(run[name])]),
        ...correctedOf(run),
        [text.infeasible, count(run.infeasible)],
        ...varietyOf(run),
      ];
  }
}

/** The distance between the motions of the elites; known at the end of a search. */
function varietyOf(run: Run): Figure[] {
  const distance = summaryOf(run, "motion_distance");
  if (distance === null) return [];
  return [
    [text.motionDistance, text.bodyLengths(number(distance))],
    [text.kindsOfMotion, count(summaryOf(run, "kinds"))],
  ];
}

/** Positions of the figure that lists show; the first one for other experiments. */
const KEY_FIGURE: Record<string, number> = { refinement: 1, neuroevolution: 2 };

export function keyFigureOf(run: Run): Figure {
  // Small measurements have no exponent: the list shows their memory.
  const small = run.experiment === "scaling" && summaryOf(run, "exponent") === null;
  const [name, value] = figuresOf(run)[small ? 2 : (KEY_FIGURE[run.experiment] ?? 0)]!;
  if (name !== text.qdScore) return [name.toLowerCase(), value];
  return [name, hasCorrected(run) ? text.andCorrected(value, number(run.corrected_qd_score)) : value];
}

/** The name of a generation of a run. */
export const generationsOf = ({ experiment }: Run) =>
  (text.generations as Record<string, string>)[experiment] ?? text.generation;

const LIMITS: Record<string, (limit: number) => string> = {
  evaluations: (limit) => text.budgetEvaluations(count(limit)),
  device_hours: (limit) => text.budgetHours(number(limit)),
  fitness: (limit) => text.fitnessReached(number(limit)),
};

/** A sentence on why a search ended, with the limit of its spec. */
export function endReasonOf(run: Run): string {
  const reason = reasonOf(run);
  // A best fitness of 0 would read as a creature that lies still.
  if (run.coverage !== 0) return reason;
  return `${reason} ${text.noElite(count(run.infeasible), count(run.evaluations))}`;
}

function reasonOf({ summary, spec, generations }: Run): string {
  const end = endOf(summary);
  if (end === null) return generations === 1 ? text.completedOne : text.completed(count(generations));
  const [name, generation] = end;
  const limit = limitOf(spec, name);
  const reason = limit === null ? undefined : LIMITS[name]?.(limit);
  return text.endedAfter(count(generation), reason ?? text.limitMet(name.replaceAll("_", " ")));
}

function limitOf(spec: Spec, name: string): number | null {
  const limit = (((spec.search as Spec | null)?.stop as Spec | null)?.[name] ?? null) as Json;
  return typeof limit === "number" ? limit : null;
}
