/** A random creature of the first generation, which swims before the run is started. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Spec } from "../api/types";
import { useLive, LiveStage } from "../creature/live/LiveStage";
import { noWishes } from "../creature/live/touch";
import { useDebounced, usePolled } from "../store/polling";
import { text } from "./text";

/** Milliseconds without a change of the spec until the creature is asked for anew. */
const CALM_MS = 1200;

export function FirstCreature({ spec }: { spec: Spec }) {
  const [number, setNumber] = useState(0);
  const [calm, setCalm] = useState(JSON.stringify(spec));
  useDebounced(JSON.stringify(spec), CALM_MS, setCalm);
  const ask = () => api.readFirstCreature(JSON.parse(calm) as Spec, number);
  const { value: inputs, error } = usePolled(ask, [calm, number]);
  const [failed, setFailed] = useState<string | null>(null);
  const live = useLive(inputs, (reason) => setFailed(messageOf(reason)));
  const [wishes] = useState(noWishes);
  useEffect(() => setFailed(null), [inputs]);
  const problem = error ?? failed;
  return (
    <div class="first-creature">
      {problem && (
        <p class="banner warning" role="alert">
          {problem}
        </p>
      )}
      {!live && !problem && <p class="quiet small loading">{text.firstPrepared}</p>}
      {live && (
        <LiveStage
          {...{ live, wishes }}
          viscosity={live.stage.viscosity}
          speed={1}
          field="vorticity"
          onRefuse={() => {}}
          onFail={(reason) => setFailed(messageOf(reason))}
        />
      )}
      <div class="row">
        <button type="button" disabled={!live && !problem} onClick={() => setNumber(number + 1)}>
          {text.firstNext}
        </button>
        <span class="quiet small">{text.firstAbout(number + 1)}</span>
      </div>
    </div>
  );
}
