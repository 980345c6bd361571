/** The signed-in principal and its permissions. */

import { useEffect, useState } from "preact/hooks";
import { readPrincipal } from "../api/client";
import type { Principal, Owned } from "../api/types";
import { SIGNED_OUT, isSignedOut } from "../api/http";
import { update, useStore } from "./store";
import { text } from "./text";
import { useListener } from "./polling";

/** Load the principal into the store; after a failure the event stream loads it again. */
export async function loadPrincipal(): Promise<void> {
  const principal = await readPrincipal().catch(() => null);
  if (principal) update((state) => ({ ...state, principal }));
}

/** True if a request was refused because it had no valid token. */
export function useSignedOut(): boolean {
  const [signedOut, setSignedOut] = useState(isSignedOut);
  const read = () => setSignedOut(isSignedOut());
  useEffect(read, []); // A request may have been refused since the component was drawn.
  useListener(SIGNED_OUT, read);
  return signedOut;
}

/** The reason that forbids creating, or changing `thing`; null if it is allowed. */
export const useRefusal = (thing?: Owned): string | null =>
  refusalOf(
    useStore((state) => state.principal),
    thing,
  );

/** Token names are not unique, so the server has the final decision. */
export function refusalOf(principal: Principal | null, thing?: Owned): string | null {
  if (!principal || principal.scope === "admin") return null;
  if (principal.scope === "read") return text.readOnly;
  if (thing?.owner === undefined || thing.owner === principal.name) return null;
  return text.ownerOnly(thing.owner);
}
