/** The verification of a creature: its evaluation in this browser, compared with its record. */

import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Creature } from "../api/types";
import { decodeEvaluation } from "../decode/evaluation";
import type { Evaluated } from "../simulate/evaluate";
import { simulate } from "../simulate/simulator";
import { usePolled } from "../store/polling";

export interface Row {
  name: string;
  recorded: number;
  /** Null for a measure of a plug-in. */
  here: number | null;
}

/** The recorded numbers beside those found here, fitness first. */
export function compared({ fitness, measures }: NonNullable<Creature["measured"]>, found: Evaluated): Row[] {
  return Object.entries({ fitness, ...measures }).map(([name, recorded]) => ({
    name,
    recorded,
    here: found.figures[name] ?? null,
  }));
}

/** True if the bits are the same. */
export const isSame = ({ recorded, here }: Row) => Object.is(recorded, here);

interface State {
  /** The share of the simulations that are done. */
  share: number;
  found: Evaluated | null;
  /** What of the creature the simulator lacks. */
  uncovered: string | null;
  error: string | null;
}

const NOTHING: State = { share: 0, found: null, uncovered: null, error: null };

/** The state of the verification, and a function that starts it. */
export function useVerification(readInputs: () => Promise<ArrayBuffer | null>) {
  const [starts, setStarts] = useState(0);
  const [state, setState] = useState(NOTHING);
  const asked = starts > 0;
  const polled = usePolled(asked ? readInputs : null, [starts]);
  useEffect(() => {
    setState(NOTHING);
    if (!polled.value) return;
    const stop = new AbortController();
    const change = (part: Partial<State>) => {
      if (!stop.signal.aborted) setState((old) => ({ ...old, ...part }));
    };
    verify(polled.value, change, stop.signal).catch((reason) => change({ error: messageOf(reason) }));
    return () => stop.abort();
  }, [polled.value]);
  const { found, uncovered } = state;
  const error = polled.error ?? state.error;
  const running = asked && !found && !uncovered && !error;
  return { ...state, error, note: polled.note, running, start: () => setStarts(starts + 1) };
}

async function verify(
  inputs: ArrayBuffer,
  change: (part: Partial<State>) => void,
  signal: AbortSignal,
): Promise<void> {
  const { uncovered } = decodeEvaluation(inputs);
  if (uncovered !== null) return change({ uncovered });
  change({ found: await simulate(inputs, (share) => change({ share }), signal) });
}
