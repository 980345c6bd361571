/** Starting a run. */

import { useRef, useState } from "preact/hooks";
import * as api from "../../api/client";
import { Problem, messageOf } from "../../api/problem";
import type { FieldError, Spec } from "../../api/types";
import { discard } from "../../live/draft";
import { answer } from "../../live/live";
import { navigate } from "../../router";
import { newKey } from "../key";
import { SLIPPED } from "./estimating";

interface Refusal {
  spec: Spec;
  message: string;
  errors: FieldError[];
}

/** Sends the spec; the same spec sent again, after a lost answer, is the same submission. */
export function useSubmission(spec: Spec | null) {
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ spec: Spec; key: string } | null>(null);
  const start = async () => {
    if (!spec || busy) return;
    if (sent.current?.spec !== spec) sent.current = { spec, key: newKey() };
    setBusy(true);
    try {
      const run = await answer("done", api.createRun(spec, sent.current.key));
      discard();
      navigate(`/runs/${run.id}`);
    } catch (error) {
      const errors = error instanceof Problem ? error.errors : [];
      setRefusal({ spec, message: errors.length ? SLIPPED : messageOf(error), errors });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.spec === spec ? refusal : null };
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
