/** Live water that begins as soon as the inputs of an evaluation are there. */

import { useEffect, useState } from "preact/hooks";
import { decodeEvaluation } from "../../decode/evaluation";
import { Live } from "../../simulate/live";
import { text } from "./text";

/** Null until the creature is evaluated; it ends with the component, or with other inputs. */
export function useLive(inputs: ArrayBuffer | null, onFail: (reason: unknown) => void): Live | null {
  const [live, setLive] = useState<Live | null>(null);
  useEffect(() => {
    if (!inputs) return;
    let begun: Live | null = null;
    let active = true;
    begin(inputs)
      .then((found) => {
        begun = found;
        if (active) setLive(found);
        else found.end();
      })
      .catch((reason) => active && onFail(reason));
    return () => {
      active = false;
      begun?.end();
      setLive(null);
    };
  }, [inputs]);
  return live;
}

async function begin(inputs: ArrayBuffer): Promise<Live> {
  const { uncovered } = decodeEvaluation(inputs);
  if (uncovered !== null) throw new Error(text.notCovered(uncovered));
  return Live.begin(inputs);
}
