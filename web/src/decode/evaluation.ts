/** The inputs of a creature's evaluation: the operands of the calls of the native kernel. */

import { readColumns } from "./columns";

/** An array of the file, by its place. */
type Place = number;

export interface Simulation {
  /** Operands in the kernel's order; empty for a creature whose rest shapes are given. */
  develop: Place[];
  rollout: Place[];
  clock: Place;
  scales: Place;
  /** Positions of nodes at the start in whole units. */
  whole: Place;
  /** Measures that no simulation changes. */
  constant: Record<string, number>;
}

export interface Goal {
  displacement: number;
  energy: number;
  measure: string | null;
  sign: number;
}

interface Header {
  creature: string;
  /** The part of the creature that the kernel lacks; null if it carries out all of it. */
  uncovered: string | null;
  /** Null where a plug-in measures the fitness. */
  goal: Goal | null;
  /** Names of the measures that the kernel returns, in its order. */
  measures: string[];
  /** Names of the measures of which the largest over all placements and trials counts. */
  largest: string[];
  /** Steps of the last cycle, over which a gait's displacement counts; null for a creature with a genome. */
  cycle: number | null;
  /** Copies of the creature, which carry out the rest shapes of the first. */
  copies: number;
  numbers: { develop: Record<string, number>; rollout: Record<string, number> };
  /** Simulations of each trial: one for each placement of the energy. */
  trials: Simulation[][];
}

export type Items = Float32Array | Int32Array;

export interface EvaluationInputs extends Header {
  arrays: Items[];
}

export function decodeEvaluation(buffer: ArrayBuffer): EvaluationInputs {
  const { document, columns } = readColumns<Header>(buffer);
  return { ...document, arrays: columns.map(({ values }) => values as Items) };
}
