/** The button that starts a refinement run from a creature. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Creature, Json } from "../api/types";
import { useRefusal } from "../store/principal";
import { applyResponse } from "../store/store";
import { showToast } from "../store/toasts";
import { navigate } from "../store/router";
import { newIdempotencyKey } from "../ui/idempotencyKey";
import { text } from "./text";

interface Props {
  creature: Creature;
  /** The run whose cells bound the refinement, if the page was opened from one. */
  run: string | null;
}

export function RefineButton({ creature, run }: Props) {
  const [busy, setBusy] = useState(false);
  const refusal = useRefusal();
  if (refusal) return null;
  const start = async () => {
    setBusy(true);
    try {
      const archive = run ? (await api.readRun(run)).spec.archive : undefined;
      const spec = {
        experiment: "refinement",
        creature: creature as unknown as Json,
        ...(archive !== undefined && { archive }),
      };
      const made = await applyResponse("change", api.createRun(spec, newIdempotencyKey()));
      navigate(`/runs/${made.id}`);
    } catch (error) {
      showToast({ kind: "wrong", text: messageOf(error) });
      setBusy(false);
    }
  };
  return (
    <button disabled={busy} onClick={() => void start()} title={text.refineAbout}>
      {busy ? text.starting : text.refine}
    </button>
  );
}
