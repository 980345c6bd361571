/** Starting a run, a fork of one, or a sweep of runs. */

import { useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { FieldError, ForkRequest, Spec, SweepRequest } from "../api/types";
import { discardDraft } from "../store/draft";
import { applyResponse } from "../store/store";
import { navigate } from "../store/router";
import { newIdempotencyKey } from "../ui/idempotencyKey";
import { HAS_ERRORS } from "./estimate";

/** What is sent in place of a spec alone. */
export type Alternative = { sweep: SweepRequest } | { fork: ForkRequest };

interface Refusal {
  asked: Spec | Alternative;
  message: string;
  errors: FieldError[];
}

/** Sends the spec, or what is wanted instead; the same sent again, after a lost answer, is the same submission. */
export function useSubmission(spec: Spec, instead: Alternative | null) {
  const asked = instead ?? spec;
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ asked: Spec | Alternative; key: string } | null>(null);
  const start = async () => {
    if (busy) return;
    if (sent.current?.asked !== asked) sent.current = { asked, key: newIdempotencyKey() };
    setBusy(true);
    try {
      const page = await submit(spec, instead, sent.current.key);
      discardDraft();
      navigate(page);
    } catch (error) {
      const errors = error instanceof Problem ? error.errors : [];
      setRefusal({ asked, message: errors.length ? HAS_ERRORS : messageOf(error), errors });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.asked === asked ? refusal : null };
}

/** Where what was started can be seen. */
async function submit(spec: Spec, instead: Alternative | null, key: string): Promise<string> {
  if (instead && "sweep" in instead) return `/sweeps/${(await api.createSweep(instead.sweep, key)).id}`;
  const made = instead ? api.forkRun(instead.fork, key) : api.createRun(spec, key);
  return `/runs/${(await applyResponse("change", made)).id}`;
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
