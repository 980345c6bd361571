/** Who the server takes us for; and that it takes us for nobody. */

import { useEffect, useState } from "preact/hooks";
import { readCaller } from "../api/client";
import { UNKNOWN, isUnknown } from "../api/unknown";
import { type Loaded, useFetched } from "./fetching";
import type { Caller } from "../api/types";

export function useCaller(): Loaded<Caller> {
  return useFetched(readCaller, []);
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
