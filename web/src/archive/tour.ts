/** The state of the tour of an archive: open or closed. */

import { useState } from "preact/hooks";
import type { Run } from "../api/types";
import { keep, readKept } from "../store/kept";

const STORAGE_KEY = "microcosmos:tour-taken";

/** True if this browser has shown the tour; false if it forbids storage. */
export const hasTakenTour = () => readKept(STORAGE_KEY, 0) > 0;

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
    keep(STORAGE_KEY, 1);
  };
  return { open, requested, begin, end };
}
