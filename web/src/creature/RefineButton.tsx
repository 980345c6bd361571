/** Asks for a creature to be made fitter by gradients, in a run of its own. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Creature, Json } from "../api/types";
import { useRefusal } from "../store/principal";
import { applyResponse } from "../store/store";
import { showToast } from "../store/toasts";
import { navigate } from "../store/router";
import { ConfirmButton } from "../ui/ConfirmButton";
import { newIdempotencyKey } from "../ui/idempotencyKey";

interface Props {
  creature: Creature;
  /** The run whose cells count, where the creature was reached from one. */
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
      const made = await applyResponse("change", api.createRun(spec, newIdempotencyKey()));
      navigate(`/runs/${made.id}`);
    } catch (error) {
      showToast({ kind: "wrong", text: messageOf(error) });
    }
  };
  return (
    <ConfirmButton
      verb="Refine"
      what="this creature"
      queues="Queues a new run: gradient steps towards higher fitness that do not leave the creature’s cell."
      onConfirm={start}
    />
  );
}
