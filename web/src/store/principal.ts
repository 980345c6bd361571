/** Who the server takes us for; that it takes us for nobody; and what it would refuse us. */

import { useEffect, useState } from "preact/hooks";
import { readCaller } from "../api/client";
import type { Caller, Owned } from "../api/types";
import { UNKNOWN, isUnknown } from "../api/signedOut";
import { type Loaded, useFetched } from "./fetch";
import { dispatch, useLive } from "./store";

export function useCaller(): Loaded<Caller> {
  return useFetched(readCaller, []);
}

/** Keeps in the store who we are; the server may be away, and is asked again with the stream. */
export async function learnCaller(): Promise<void> {
  const caller = await readCaller().catch(() => null);
  if (caller) dispatch({ type: "caller", caller });
}

/** Whether a request was refused for want of a token; nothing works then until there is one. */
export function useUnknown(): boolean {
  const [unknown, setUnknown] = useState(isUnknown);
  useEffect(() => {
    const hear = () => setUnknown(isUnknown());
    hear();
    window.addEventListener(UNKNOWN, hear);
    return () => window.removeEventListener(UNKNOWN, hear);
  }, []);
  return unknown;
}

/** Why we may not make anything here, or not change what somebody made; null where we may. */
export const useRefusal = (thing?: Owned): string | null =>
  refusalOf(
    useLive((state) => state.caller),
    thing,
  );

/** Names of tokens need not differ: where they are the same, the server has the last word. */
export function refusalOf(caller: Caller | null, thing?: Owned): string | null {
  if (!caller || caller.scope === "admin") return null;
  if (caller.scope === "read") return "Your token may only look.";
  if (thing?.owner === undefined || thing.owner === caller.name) return null;
  const owner = thing.owner ? `${thing.owner} or an admin` : "an admin";
  return `Only ${owner} may change it.`;
}
