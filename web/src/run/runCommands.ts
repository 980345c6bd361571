/** Handlers of the command buttons of a run. */

import type { Run } from "../api/types";
import { sendCommand, cancelWithUndo } from "../store/commands";

export const commandsFor = (title: string) => ({
  pause: (run: Run) => void sendCommand(run.id, "pause"),
  resume: (run: Run) => void sendCommand(run.id, "resume"),
  cancel: (run: Run) => cancelWithUndo(run.id, title),
});
