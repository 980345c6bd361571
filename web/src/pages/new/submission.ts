/** Starting a run, or a sweep of runs. */

import { useRef, useState } from "preact/hooks";
import * as api from "../../api/client";
import { Problem, messageOf } from "../../api/problem";
import type { FieldError, Spec, SweepSent } from "../../api/types";
import { discard } from "../../live/draft";
import { answer } from "../../live/live";
import { navigate } from "../../router";
import { newKey } from "../key";
import { SLIPPED } from "./estimating";

interface Refusal {
  asked: Spec | SweepSent;
  message: string;
  errors: FieldError[];
}

/** Sends the spec or the sweep; the same sent again, after a lost answer, is the same submission. */
export function useSubmission(spec: Spec | null, sweep: SweepSent | null) {
  const asked = sweep ?? spec;
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ asked: Spec | SweepSent; key: string } | null>(null);
  const start = async () => {
    if (!spec || !asked || busy) return;
    if (sent.current?.asked !== asked) sent.current = { asked, key: newKey() };
    setBusy(true);
    try {
      const page = await submit(spec, sweep, sent.current.key);
      discard();
      navigate(page);
    } catch (error) {
      const errors = error instanceof Problem ? error.errors : [];
      setRefusal({ asked, message: errors.length ? SLIPPED : messageOf(error), errors });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.asked === asked ? refusal : null };
}

/** Where what was started can be seen. */
async function submit(spec: Spec, sweep: SweepSent | null, key: string): Promise<string> {
  if (sweep) return `/sweeps/${(await api.createSweep(sweep, key)).id}`;
  return `/runs/${(await answer("done", api.createRun(spec, key))).id}`;
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
