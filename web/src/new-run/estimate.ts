/** Estimated costs, and the errors that the server finds. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { Estimate, Experiment, FieldError, Preset } from "../api/types";
import { text } from "./text";

const SETTLED_MS = 350;

/** An error of the server: its fields, and a sentence. */
export function serverErrors(error: unknown): { errors: FieldError[]; problem: string } {
  const errors = error instanceof Problem ? error.errors : [];
  return { errors, problem: errors.length > 0 ? text.hasErrors : messageOf(error) };
}

interface Check<T> {
  estimate: T | null;
  errors: FieldError[];
  problem: string | null;
}

/** Ask for an estimate after a pause in typing; the last answer stays until the next one. */
export function useEstimate<Requested, T>(
  requested: Requested | null,
  estimateOf: (requested: Requested) => Promise<T>,
): Check<T> {
  const unchecked = { estimate: null, errors: [], problem: null };
  const [check, setCheck] = useState<Check<T>>(unchecked);
  useEffect(() => {
    if (requested === null) return setCheck(unchecked);
    let wanted = true;
    const show = (next: Partial<Check<T>>) => wanted && setCheck({ ...unchecked, ...next });
    const timer = setTimeout(() => {
      estimateOf(requested).then(
        (estimate) => show({ estimate }),
        (error) => show(serverErrors(error)),
      );
    }, SETTLED_MS);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [requested]);
  return check;
}

/** The estimated cost of each preset of an experiment; a preset without an answer shows none. */
export function usePresetCosts({ presets }: Experiment): ReadonlyMap<Preset, Estimate> {
  const [known, setKnown] = useState<ReadonlyMap<Preset, Estimate>>(new Map());
  useEffect(() => {
    for (const preset of presets.filter((one) => !known.has(one))) {
      api.estimateRun(preset.spec).then(
        (estimate) => setKnown((old) => new Map(old).set(preset, estimate)),
        () => {},
      );
    }
  }, [presets]);
  return known;
}
