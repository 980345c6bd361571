/** A check of a creature that the server computes when it is ordered. */

import { useState } from "preact/hooks";
import type { OrNever } from "../api/client";
import { messageOf } from "../api/problem";
import { usePolled } from "../store/polling";

export interface Check<T> {
  /** Null while it is not known, and without an order. */
  result: T | null;
  /** Nobody has ordered it. */
  never: boolean;
  running: boolean;
  note: string | null;
  error: string | null;
  start: () => Promise<void>;
}

/** The result of a check, and a function that orders it. */
export function useCheck<T>(
  sha: string,
  read: (sha: string) => Promise<OrNever<T>>,
  order: (sha: string) => Promise<unknown>,
): Check<T> {
  const [orders, setOrders] = useState(0);
  const [starting, setStarting] = useState(false);
  const [failed, setFailed] = useState<string | null>(null);
  const { value, answered, note, error } = usePolled(() => read(sha), [sha, orders]);
  const start = async () => {
    setFailed(null);
    setStarting(true);
    try {
      await order(sha);
      setOrders((count) => count + 1);
    } catch (reason) {
      setFailed(messageOf(reason));
    }
    setStarting(false);
  };
  const known = starting ? null : value;
  return {
    result: known === "never" ? null : known,
    never: known === "never",
    running: starting || (answered && value === null),
    note,
    error: failed ?? error,
    start,
  };
}
