/** Curves of runs that learn by gradients. */

import type { Run } from "../../api/types";
import type { Curves } from "../../store/curves";
import { count, number } from "../../ui/format";
import type { Axis, Line } from "../../charts/plot/Plot";
import { fromZero, logAround } from "../../charts/plot/scale";
import { text } from "./text";

/** The largest number of marks on a line. */
const MARKS = 120;
const LOSS = "loss of ";

export interface Course {
  title: string;
  x: Axis;
  y: Axis;
  lines: Line[];
}

/** The loss of each filament, or the fitness of a creature, by step. */
export function courseOf(run: Run, curves: Curves): Course {
  const folds = run.experiment === "folding";
  // A refinement measures its creature before the first step.
  const before = folds ? 0 : 1;
  const names = Object.keys(curves.summary).filter((name) =>
    folds ? name.startsWith(LOSS) : name === "fitness",
  );
  const lines = names.map((name, k) => lineOf(name, curves, before, k));
  const values = lines.flatMap(({ points }) => points.map(({ y }) => y ?? 0));
  const rises = around(values);
  const steps = { log: false, low: 0, high: Math.max(1, run.generations - before) };
  return {
    title: folds ? text.lossAgainstUpdates : text.fitnessAgainstSteps,
    x: { title: folds ? text.update : text.stepAxis, scale: steps, write: count },
    y: folds
      ? { title: text.lossAxis, scale: logAround(values), write: (value) => number(value, 2) }
      : { title: text.fitnessAxis, scale: rises, write: (value) => number(value, digitsOf(rises)) },
    lines,
  };
}

function lineOf(column: string, curves: Curves, before: number, k: number): Line {
  const [name, values] = [column.replace(LOSS, ""), curves.summary[column]!];
  const step = (i: number) => curves.generation[i]! - before;
  const every = Math.max(1, Math.ceil(values.length / MARKS));
  const kept = values.map((_, i) => i).filter((i) => i % every === 0 || i === values.length - 1);
  return {
    name,
    colour: `--series-${1 + (k % 5)}`,
    ...(k >= 5 && { dash: "6 4" }),
    points: kept
      .filter((i) => values[i] !== null)
      .map((i) => ({
        x: step(i),
        y: values[i]!,
        says: [name, text.afterCount(count(step(i))), number(values[i]!)],
      })),
  };
}

/** A linear scale that need not start at zero. */
function around(values: number[]): Axis["scale"] {
  if (values.length === 0) return fromZero([1]);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const beside = 0.07 * (high - low || Math.abs(high) || 1);
  return { log: false, low: low - beside, high: high + beside };
}

/** Digits that tell the ticks of an axis apart. */
const digitsOf = ({ low, high }: Axis["scale"]) =>
  2 + Math.max(0, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / (high - low))));
