/** The scheduling of a run: its workers and its priority; editable until it has ended. */

import { useState } from "preact/hooks";
import type { Run } from "../api/types";
import { editRun } from "../store/commands";
import { useRefusal } from "../store/principal";
import { Card } from "../ui/Page";
import { Check, Select } from "../ui/Select";
import { duration } from "../ui/format";
import { text } from "./text";

const OPEN = ["queued", "running", "paused"];
const HOUR = 3600;
/** Seconds that can be selected. */
const PATIENCE = [0, HOUR, 6 * HOUR, 24 * HOUR, 7 * 24 * HOUR];
const NEVER = "never";

export function SchedulingCard({ run }: { run: Run }) {
  const refusal = useRefusal(run);
  if (!OPEN.includes(run.status) || run.deleted_at || refusal) return null;
  const patience = run.device_patience === null ? NEVER : String(run.device_patience);
  return (
    <Card id="scheduling" kind="scheduling" title={text.scheduling}>
      <Select
        title={text.priority}
        choices={text.priorities}
        value={run.priority}
        onChange={(name) => void editRun(run.id, { priority: name as Run["priority"] })}
      />
      <p class="quiet small">{text.priorityHint}</p>
      <Labels run={run} />
      <Select
        title={text.otherDevice}
        choices={patienceChoices(run.device_patience)}
        value={patience}
        onChange={(name) => void editRun(run.id, { device_patience: name === NEVER ? null : Number(name) })}
      />
      <p class="quiet small">{text.otherDeviceHint}</p>
      <Check
        title={text.mayYield}
        on={run.may_yield}
        onChange={(may_yield) => void editRun(run.id, { may_yield })}
      />
    </Card>
  );
}

function Labels({ run }: { run: Run }) {
  // Kept while it is typed: events draw the card again.
  const [typed, setTyped] = useState<string | null>(null);
  return (
    <label class="compact">
      {text.labels}
      <input
        value={typed ?? run.labels.join(", ")}
        placeholder={text.labelsHint}
        autocomplete="off"
        onInput={({ currentTarget }) => setTyped(currentTarget.value)}
        onChange={({ currentTarget }) => void editRun(run.id, { labels: labelsIn(currentTarget.value) })}
        onBlur={() => setTyped(null)}
      />
    </label>
  );
}

const labelsIn = (words: string) => [...new Set(words.split(/[\s,]+/))].filter((word) => word !== "");

/** The usual choices, with the present one among them. */
function patienceChoices(present: number | null): [string, string][] {
  const seconds = present === null || PATIENCE.includes(present) ? PATIENCE : [...PATIENCE, present];
  const title = (one: number) => (one ? text.patience.after(duration(one)) : text.patience.now);
  return [
    [NEVER, text.patience.never],
    ...seconds.toSorted((a, b) => a - b).map((one): [string, string] => [String(one), title(one)]),
  ];
}
