/** What of a run is kept while somebody looks at it, and a little longer. */

import { dispatch } from "./store";

/** Whoever comes back by then finds all as it was. */
export const RETAIN_MS = 60_000;

/** Keeps the details or the curves of runs; answers what lets go of them. */
export function retain(type: "open" | "watch", runs: readonly string[]): () => void {
  for (const run of runs) dispatch({ type, run, more: 1 });
  return () => {
    setTimeout(() => runs.forEach((run) => dispatch({ type, run, more: -1 })), RETAIN_MS);
  };
}
