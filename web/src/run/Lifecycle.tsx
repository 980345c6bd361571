/** Extending, deleting and restoring a run, and its origin. */

import type { Run } from "../api/types";
import { useRefusal } from "../store/principal";
import { extend, remove, restore } from "../store/commands";
import { dateTime, shortId } from "../ui/format";
import { endOf } from "../store/figureNames";
import { useDisclosure } from "../ui/forms";
import { InlineForm } from "./RunPicker";
import { text } from "./text";

const ENDED = ["finished", "failed", "cancelled", "paused"];

export function LifecycleButtons({ run, title }: { run: Run; title: string }) {
  if (run.deleted_at || !ENDED.includes(run.status)) return null;
  return (
    <span class="actions">
      {extendable(run) && <Extend run={run} />}
      <button class="danger" onClick={() => void remove(run.id, title)} aria-label={text.deleteRun(title)}>
        {text.delete}
      </button>
    </span>
  );
}

/** A run that met a stopping condition cannot be extended. */
const extendable = (run: Run) =>
  run.status === "finished" && "search" in run.spec && endOf(run.summary) === null;

function Extend({ run }: { run: Run }) {
  const { open, setOpen, button, first: field } = useDisclosure<HTMLInputElement>();
  if (!open) {
    return (
      <button ref={button} onClick={() => setOpen(true)}>
        {text.extend}
      </button>
    );
  }
  const send = async () => {
    const more = field.current?.valueAsNumber ?? NaN;
    if (more >= 1 && (await extend(run.id, more))) setOpen(false);
  };
  return (
    <InlineForm onSubmit={() => void send()} onClose={() => setOpen(false)}>
      <label>
        {text.generationsToAdd}{" "}
        <input
          ref={field}
          type="number"
          min={1}
          max={1_000_000}
          required
          defaultValue={String(run.generations)}
        />
      </label>
      <button class="slim">{text.addGenerations}</button>
    </InlineForm>
  );
}

export function ForkedFrom({ run }: { run: Run }) {
  const from = run.forked_from;
  if (!from) return null;
  return (
    <p class="quiet">
      {text.forkedFrom(from.creatures)}
      {from.run ? <a href={`/runs/${from.run}`}>{text.runOf(shortId(from.run))}</a> : text.deletedRun}.
    </p>
  );
}

/** Shown instead of the page while a run is in the bin. */
export function BinNotice({ run }: { run: Run }) {
  const refusal = useRefusal(run);
  return (
    <p class="banner warning" role="status">
      {text.inBin(run.purge_at && dateTime(run.purge_at))}{" "}
      {refusal ?? <button onClick={() => void restore(run.id)}>{text.restore}</button>}
    </p>
  );
}
