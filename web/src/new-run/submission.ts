/** Starting a run, a fork of one, or a sweep of runs. */

import { useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { FieldError, ForkSent, Spec, SweepSent } from "../api/types";
import { discard } from "../store/draft";
import { answer } from "../store/store";
import { navigate } from "../store/router";
import { newKey } from "../ui/idempotencyKey";
import { SLIPPED } from "./estimate";

/** What is sent in place of a spec alone. */
export type Instead = { sweep: SweepSent } | { fork: ForkSent };

interface Refusal {
  asked: Spec | Instead;
  message: string;
  errors: FieldError[];
}

/** Sends the spec, or what is wanted instead; the same sent again, after a lost answer, is the same submission. */
export function useSubmission(spec: Spec, instead: Instead | null) {
  const asked = instead ?? spec;
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ asked: Spec | Instead; key: string } | null>(null);
  const start = async () => {
    if (busy) return;
    if (sent.current?.asked !== asked) sent.current = { asked, key: newKey() };
    setBusy(true);
    try {
      const page = await submit(spec, instead, sent.current.key);
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
async function submit(spec: Spec, instead: Instead | null, key: string): Promise<string> {
  if (instead && "sweep" in instead) return `/sweeps/${(await api.createSweep(instead.sweep, key)).id}`;
  const made = instead ? api.forkRun(instead.fork, key) : api.createRun(spec, key);
  return `/runs/${(await answer("done", made)).id}`;
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
