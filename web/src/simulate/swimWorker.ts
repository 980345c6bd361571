/** The web worker in which creatures swim on: it begins with one, then takes steps on request. */

import { decodeEvaluation } from "../decode/evaluation";
import type { Advanced, Begin, Event, Steps } from "./live";
import { Swim } from "./swim";

let swim: Swim | null = null;

self.onmessage = ({ data }: MessageEvent<Begin | Steps>) => {
  const answer = (event: Event) => self.postMessage(event);
  try {
    if ("module" in data) {
      swim = new Swim(data.module, decodeEvaluation(data.inputs));
      answer({ stage: swim.stage });
    } else answer(advanced(swim!, data));
  } catch (error) {
    answer({ error: messageOf(error) });
  }
};

function advanced(swim: Swim, { viscosity, speed, pushes, pull, joining, steps }: Steps): Advanced {
  const refused = join(swim, joining);
  swim.viscosity = viscosity;
  swim.speed = speed;
  for (const { away, velocity } of pushes) swim.push(away, velocity);
  if (!pull) swim.advance(steps);
  for (let step = 0; pull && step < steps; step++) {
    swim.pull(pull.node, pull.away);
    swim.advance(1);
  }
  return { frame: swim.frame(), refused };
}

/** Let creatures join; return why one could not. */
function join(swim: Swim, joining: ArrayBuffer[]): string | null {
  let refused: string | null = null;
  for (const inputs of joining) {
    try {
      swim.join(decodeEvaluation(inputs));
    } catch (error) {
      refused = messageOf(error);
    }
  }
  return refused;
}

const messageOf = (error: unknown) => (error instanceof Error ? error.message : String(error));
