/** The web worker that evaluates creatures, so that the page stays responsive. */

import { decodeEvaluation } from "../decode/evaluation";
import { evaluate } from "./evaluate";
import type { Answer, Order } from "./simulator";

self.onmessage = ({ data: { module, inputs } }: MessageEvent<Order>) => {
  const answer = (message: Answer) => self.postMessage(message);
  try {
    const found = evaluate(module, decodeEvaluation(inputs), (share) => answer({ share }));
    answer({ found });
  } catch (error) {
    answer({ error: error instanceof Error ? error.message : String(error) });
  }
};
