/** Starting a run, a fork of one, or a sweep of runs. */

import { useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import type { ForkRequest, Spec, SweepRequest } from "../api/types";
import { discardDraft } from "../store/draft";
import { applyResponse } from "../store/store";
import { navigate } from "../store/router";
import { newIdempotencyKey } from "../ui/idempotencyKey";
import { serverErrors } from "./estimate";

export type Alternative = { sweep: SweepRequest } | { fork: ForkRequest };

type Refusal = ReturnType<typeof serverErrors> & { requested: Spec | Alternative };

/** Send the spec, or another request; the same request sent again after a lost answer has the same key. */
export function useSubmission(spec: Spec, instead: Alternative | null) {
  const requested = instead ?? spec;
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ requested: Spec | Alternative; key: string } | null>(null);
  const start = async () => {
    if (busy) return;
    if (sent.current?.requested !== requested) sent.current = { requested, key: newIdempotencyKey() };
    setBusy(true);
    try {
      const page = await submit(spec, instead, sent.current.key);
      discardDraft();
      navigate(page);
    } catch (error) {
      setRefusal({ requested, ...serverErrors(error) });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.requested === requested ? refusal : null };
}

async function submit(spec: Spec, instead: Alternative | null, key: string): Promise<string> {
  if (instead && "sweep" in instead) return `/sweeps/${(await api.createSweep(instead.sweep, key)).id}`;
  const made = instead ? api.forkRun(instead.fork, key) : api.createRun(spec, key);
  return `/runs/${(await applyResponse("change", made)).id}`;
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
