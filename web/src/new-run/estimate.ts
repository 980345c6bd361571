/** What a spec will cost, and what the server finds wrong with it. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { Drawing, Estimate, Experiment, FieldError, Preset, Spec } from "../api/types";

const SETTLED_MS = 350;

export const HAS_ERRORS = "Some values cannot be used; see beside them.";

export interface Check {
  estimate: Estimate | null;
  /** What was last drawn; it stays while values are being typed. */
  drawing: Drawing | null;
  errors: FieldError[];
  problem: string | null;
}

const UNCHECKED: Check = { estimate: null, drawing: null, errors: [], problem: null };

/** Asks once typing has settled, and not for what the form itself finds wrong. */
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

/** What each preset of an experiment would cost; asked anew whenever the page is opened. */
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
