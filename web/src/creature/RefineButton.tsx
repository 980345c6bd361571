/** The button that starts a refinement run from a creature. */

import * as api from "../api/client";
import type { Creature, Json } from "../api/types";
import { useRefusal } from "../store/principal";
import { applyResponse } from "../store/store";
import { showFailure } from "../store/toasts";
import { navigate } from "../store/router";
import { ConfirmButton } from "../ui/ConfirmButton";
import { newIdempotencyKey } from "../ui/forms";
import { text } from "./text";

interface Props {
  creature: Creature;
  /** The run whose cells bound the refinement, if the page was opened from one. */
  run: string | null;
}

export function RefineButton({ creature, run }: Props) {
  const refusal = useRefusal();
  if (refusal) return null;
  const start = async () => {
    try {
      const archive = run ? (await api.readRun(run)).spec.archive : undefined;
      const spec = {
        experiment: "refinement",
        creature: creature as unknown as Json,
        ...(archive !== undefined && { archive }),
      };
      const made = await applyResponse("change", api.createRun(spec, newIdempotencyKey(), null));
      navigate(`/runs/${made.id}`);
    } catch (error) {
      showFailure(error);
    }
  };
  return (
    <ConfirmButton verb={text.refine} what={text.refineWhat} queues={text.refineAbout} onConfirm={start} />
  );
}
