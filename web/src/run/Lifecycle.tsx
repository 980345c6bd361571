/** More generations for a run that is done, its way into the bin, and where it came from. */

import type { Run } from "../api/types";
import { useRefusal } from "../store/principal";
import { extend, remove, restore } from "../store/lifecycle";
import { count, moment, short } from "../ui/format";
import { useDisclosure } from "../ui/disclosure";

const ENDED = ["finished", "failed", "cancelled", "paused"];

export function LifecycleButtons({ run, title }: { run: Run; title: string }) {
  if (run.deleted_at || !ENDED.includes(run.status)) return null;
  return (
    <span class="actions">
      {extendable(run) && <Extend run={run} />}
      <button class="danger" onClick={() => void remove(run.id, title)} aria-label={`Delete ${title}`}>
        Delete
      </button>
    </span>
  );
}

/** What a goal ended, a longer run would end at too. */
const extendable = (run: Run) => run.status === "finished" && "search" in run.spec && !run.summary?.["ended"];

function Extend({ run }: { run: Run }) {
  const { open, setOpen, button, first: field } = useDisclosure<HTMLInputElement>();
  if (!open) {
    return (
      <button ref={button} onClick={() => setOpen(true)}>
        Extend
      </button>
    );
  }
  const send = async (event: Event) => {
    event.preventDefault();
    const more = field.current?.valueAsNumber ?? NaN;
    if (more >= 1 && (await extend(run.id, more))) setOpen(false);
  };
  return (
    <form
      class="run-choice"
      onSubmit={(event) => void send(event)}
      onKeyDown={(event) => event.key === "Escape" && setOpen(false)}
    >
      <label>
        Generations more{" "}
        <input
          ref={field}
          type="number"
          min={1}
          max={1_000_000}
          required
          defaultValue={String(run.generations)}
        />
      </label>
      <button class="slim">Extend</button>
      <button type="button" class="slim" onClick={() => setOpen(false)}>
        Close
      </button>
    </form>
  );
}

/** Where a fork began. */
export function ForkedFrom({ run }: { run: Run }) {
  const from = run.forked_from;
  if (!from) return null;
  const creatures = from.creatures === 1 ? "one creature" : `${count(from.creatures)} creatures`;
  return (
    <p class="quiet">
      Began from {creatures} of{" "}
      {from.run ? <a href={`/runs/${from.run}`}>run {short(from.run)}</a> : "a run that is gone"}.
    </p>
  );
}

/** In place of a run's page while it lies in the bin. */
export function BinNotice({ run }: { run: Run }) {
  const refusal = useRefusal(run);
  return (
    <p class="banner warning" role="status">
      This run is in the bin until {run.purge_at && moment(run.purge_at)}; then it goes for good.{" "}
      {refusal ?? <button onClick={() => void restore(run.id)}>Restore</button>}
    </p>
  );
}
