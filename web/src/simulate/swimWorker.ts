/** The web worker in which a creature swims on: it begins with its inputs, then takes steps on request. */

import { decodeEvaluation } from "../decode/evaluation";
import type { Begin, Event, Steps } from "./live";
import { Swim } from "./swim";

let swim: Swim | null = null;

self.onmessage = ({ data }: MessageEvent<Begin | Steps>) => {
  const answer = (event: Event) => self.postMessage(event);
  try {
    if ("module" in data) {
      swim = new Swim(data.module, decodeEvaluation(data.inputs));
      answer({ stage: swim.stage });
    } else {
      swim!.viscosity = data.viscosity;
      swim!.speed = data.speed;
      for (const { away, velocity } of data.pushes) swim!.push(away, velocity);
      swim!.advance(data.steps);
      answer({ frame: swim!.frame() });
    }
  } catch (error) {
    answer({ error: error instanceof Error ? error.message : String(error) });
  }
};
