/** The web worker that evaluates creatures, or lets them swim on, so that the page stays responsive. */

import { decodeEvaluation } from "../decode/evaluation";
import { evaluate } from "./evaluate";
import type { Advanced, Answer, Begin, Steps } from "./simulator";
import { Swim } from "./swim";

let swim: Swim | null = null;

self.onmessage = ({ data }: MessageEvent<Begin | Steps>) => {
  const answer = (message: Answer) => self.postMessage(message);
  try {
    if ("steps" in data) answer(advanced(swim!, data));
    else if (data.live) {
      swim = new Swim(data.module, decodeEvaluation(data.inputs));
      answer({ stage: swim.stage });
    } else {
      const found = evaluate(data.module, decodeEvaluation(data.inputs), (share) => answer({ share }));
      answer({ found });
    }
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
