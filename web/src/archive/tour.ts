/** When the tour of an archive is open. */

import { useState } from "preact/hooks";
import type { Run } from "../api/types";

const STORAGE_KEY = "microcosmos:tour-taken";

/** True if this browser has shown the tour; false if it forbids storage. */
export function hasTakenTour(): boolean {
  try {
    return localStorage.getItem(STORAGE_KEY) !== null;
  } catch {
    return false;
  }
}

/** The tour opens by itself over the demonstration only. */
export const opensByItself = (run: Pick<Run, "demonstration">) => run.demonstration && !hasTakenTour();

/** Open on the first visit of the demonstration, and on request. */
export function useTour(run: Run) {
  const [open, setOpen] = useState(() => opensByItself(run));
  const [requested, setRequested] = useState(false);
  const begin = () => {
    setRequested(true);
    setOpen(true);
  };
  const end = () => {
    setOpen(false);
    try {
      localStorage.setItem(STORAGE_KEY, "1");
    } catch {
      // The tour is offered again.
    }
  };
  return { open, requested, begin, end };
}
