/** The buttons of a run, bound to what they ask of the server. */

import type { Run } from "../api/types";
import { ask, cancelSoon } from "../store/commands";

export const ON = (title: string) => ({
  pause: (run: Run) => void ask(run.id, "pause"),
  resume: (run: Run) => void ask(run.id, "resume"),
  cancel: (run: Run) => cancelSoon(run.id, title),
});
