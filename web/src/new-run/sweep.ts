/** The state of a sweep: seeds, and fields of the grid. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Experiment, FieldError, Spec, SweepRequest } from "../api/types";
import type { Leaf, Section } from "./form/fields";
import { type Axis, MOST, hasSeed, readSeeds, readValues, sweepable } from "./sweepGrid";
import { text } from "./text";

export interface SweepForm {
  seeded: boolean;
  seeds: string;
  axes: readonly Axis[];
  name: string;
  fields: readonly Leaf[];
  problems: { seeds: string | null; axes: (string | null)[]; total: string | null };
  total: number;
  /** The request; null for a single run or invalid values. */
  sent: SweepRequest | null;
  change: (change: Partial<Typed>) => void;
}

interface Typed {
  seeds: string;
  axes: readonly Axis[];
  name: string;
}

const SINGLE: Typed = { seeds: "1", axes: [], name: "" };

/** Keep typed values while the spec changes; report fields that no longer exist. */
export function useSweepForm(form: Section, spec: Spec, experiment: Experiment): SweepForm {
  const [typed, setTyped] = useState(SINGLE);
  useEffect(() => setTyped(SINGLE), [experiment]);
  const read = useMemo(() => readAll(form, spec, hasSeed(experiment), typed), [form, spec, typed]);
  const change = (next: Partial<Typed>) => setTyped((now) => ({ ...now, ...next }));
  return { ...typed, ...read, change };
}

function readAll(form: Section, spec: Spec, seeded: boolean, typed: Typed) {
  const fields = sweepable(form, spec);
  const { seeds, problem } = seeded ? readSeeds(typed.seeds) : { seeds: 1, problem: null };
  const readings = typed.axes.map(({ path, text: typed }) => {
    const field = fields.find((one) => one.path === path);
    return field ? readValues(field, typed) : { values: [], problem: text.fieldGone };
  });
  const total = readings.reduce((product, { values }) => product * values.length, seeds);
  const many = total > MOST ? text.tooManyRuns(MOST.toLocaleString("en"), total) : null;
  const problems = { seeds: problem, axes: readings.map((one) => one.problem), total: many };
  const right = !problem && !many && readings.every((one) => one.problem === null);
  const grid = Object.fromEntries(typed.axes.map(({ path }, i) => [path, readings[i]!.values]));
  const wanted = right && (total > 1 || typed.axes.length > 0);
  const sent = wanted ? { spec, seeds, grid, name: typed.name.trim() || null } : null;
  return { seeded, fields, problems, total, sent };
}

/** True if more than one run is asked for, even with invalid values. */
export const isSweep = ({ seeds, axes }: SweepForm) => axes.length > 0 || seeds.trim() !== "1";

/** Errors of the server for one field of the grid, or for the seeds. */
export function complaintsOf(errors: readonly FieldError[], path: string): string[] {
  const mine = errors.filter(({ field }) => field === path || field.startsWith(`${path}[`));
  return mine.map(({ message }) => message);
}
