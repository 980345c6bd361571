/** Who the server takes us for; that it takes us for nobody; and what it would refuse us. */

import { useEffect, useState } from "preact/hooks";
import { readPrincipal } from "../api/client";
import type { Principal, Owned } from "../api/types";
import { SIGNED_OUT, isSignedOut } from "../api/signedOut";
import { type Loaded, useFetched } from "./fetch";
import { dispatch, useStore } from "./store";

export function usePrincipal(): Loaded<Principal> {
  return useFetched(readPrincipal, []);
}

/** Keeps in the store who we are; the server may be away, and is asked again with the stream. */
export async function loadPrincipal(): Promise<void> {
  const principal = await readPrincipal().catch(() => null);
  if (principal) dispatch({ type: "principal", principal });
}

/** Whether a request was refused for want of a token; nothing works then until there is one. */
export function useSignedOut(): boolean {
  const [unknown, setUnknown] = useState(isSignedOut);
  useEffect(() => {
    const hear = () => setUnknown(isSignedOut());
    hear();
    window.addEventListener(SIGNED_OUT, hear);
    return () => window.removeEventListener(SIGNED_OUT, hear);
  }, []);
  return unknown;
}

/** Why we may not make anything here, or not change what somebody made; null where we may. */
export const useRefusal = (thing?: Owned): string | null =>
  refusalOf(
    useStore((state) => state.principal),
    thing,
  );

/** Names of tokens need not differ: where they are the same, the server has the last word. */
export function refusalOf(principal: Principal | null, thing?: Owned): string | null {
  if (!principal || principal.scope === "admin") return null;
  if (principal.scope === "read") return "Your token may only look.";
  if (thing?.owner === undefined || thing.owner === principal.name) return null;
  const owner = thing.owner ? `${thing.owner} or an admin` : "an admin";
  return `Only ${owner} may change it.`;
}
