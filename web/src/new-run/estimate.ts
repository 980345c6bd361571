/** The estimated cost of a spec, and the errors that the server finds. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { Drawing, Estimate, Experiment, FieldError, Preset, Spec } from "../api/types";
import { text } from "./text";

const SETTLED_MS = 350;

export const HAS_ERRORS = text.hasErrors;

export interface Check {
  estimate: Estimate | null;
  /** The last drawing; it stays while values are typed. */
  drawing: Drawing | null;
  errors: FieldError[];
  problem: string | null;
}

const UNCHECKED: Check = { estimate: null, drawing: null, errors: [], problem: null };

/** Ask the server after a pause in typing, unless the form finds errors itself. */
export function useEstimate(spec: Spec | null, slips: FieldError[]): Check {
  const [check, setCheck] = useState(UNCHECKED);
  useEffect(() => {
    if (!spec) return;
    if (slips.length > 0) {
      return setCheck((old) => ({ ...old, estimate: null, errors: [], problem: HAS_ERRORS }));
    }
    let wanted = true;
    const show = (next: Partial<Check>) => {
      if (wanted) setCheck(({ drawing }) => ({ ...UNCHECKED, drawing, ...next }));
    };
    const timer = setTimeout(() => {
      api
        .estimateRun(spec)
        .then((estimate) => show({ estimate, drawing: estimate.drawing }))
        .catch((error) => {
          const errors = error instanceof Problem ? error.errors : [];
          show({ errors, problem: errors.length ? HAS_ERRORS : messageOf(error) });
        });
    }, SETTLED_MS);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [spec, slips]);
  return check;
}

/** The estimated cost of each preset of an experiment. */
export function usePresetCosts({ presets }: Experiment): ReadonlyMap<Preset, Estimate> {
  const [known, setKnown] = useState<ReadonlyMap<Preset, Estimate>>(new Map());
  useEffect(() => {
    const learn = (preset: Preset, estimate: Estimate) =>
      setKnown((old) => new Map(old).set(preset, estimate));
    for (const preset of presets.filter((one) => !known.has(one))) {
      // Without an answer a preset shows no cost; the spec's own estimate tells what is wrong.
      api.estimateRun(preset.spec).then(
        (estimate) => learn(preset, estimate),
        () => {},
      );
    }
  }, [presets]);
  return known;
}
