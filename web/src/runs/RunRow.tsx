/** A run in the list: status, labels edited in place, result and actions. */

import type { Experiment, Run } from "../api/types";
import type { PoseStream } from "../decode/poses";
import { SwimmingBody } from "../replay/SwimmingBody";
import { useRefusal } from "../store/principal";
import { useStore } from "../store/store";
import { editRun, restore, addTag, removeNote, removeTag } from "../store/commands";
import { NotForceFree, forceFreeShare } from "../ui/coupling";
import { dateTime, shortId, titleOf } from "../ui/format";
import { CommandButtons, timeOf } from "../run/RunStatus";
import { NameField } from "../run/NameField";
import type { RunColumn } from "./columns";
import { text } from "./text";
import { setQuery } from "../store/router";
import { InlineText } from "../ui/InlineText";
import { useDisclosure } from "../ui/forms";

interface Props {
  id: string;
  /** The pose stream of its face. */
  face: PoseStream | null;
  columns: readonly RunColumn[];
  experiments: Experiment[];
  selected: boolean;
  knownTags: string;
  onSelect: () => void;
}

export function RunRow({ id, face, columns, experiments, selected, knownTags, onSelect }: Props) {
  const run = useStore((state) => state.runs.get(id));
  const refusal = useRefusal(run);
  if (!run) return null; // Just removed for good.
  const title = titleOf(run, experiments);
  const name = `${title} ${shortId(run.id)}`;
  const readOnly = refusal !== null || run.deleted_at !== null;
  return (
    <tr class={selected ? "selected-row" : ""}>
      <td class="row-choice">
        {!run.deleted_at && (
          <input type="checkbox" aria-label={text.compareRun(name)} checked={selected} onChange={onSelect} />
        )}
      </td>
      <td class="face">{run.face && <SwimmingBody stream={face} onWater />}</td>
      <th scope="row">
        <RowTitle {...{ run, title, name, readOnly }} />
        <RowNotes run={run} />
        <span class="labels row">
          <TagList {...{ run, name, readOnly }} known={knownTags} />
          <NoteField {...{ run, name, readOnly }} />
        </span>
      </th>
      {columns.map(({ id, title: column, kind, cell }) => (
        <td key={id} data-label={id === "time" ? timeOf(run).label : column} class={kind}>
          {cell(run, name)}
        </td>
      ))}
      <RowActions {...{ run, title, name }} />
    </tr>
  );
}

interface PartProps {
  run: Run;
  title: string;
  /** The title with the run's id. */
  name: string;
  readOnly: boolean;
}

function RowTitle({ run, title, name, readOnly }: PartProps) {
  return (
    <>
      <NameField of={run} {...{ title, readOnly }} onName={(name) => void editRun(run.id, { name })}>
        <a class="run-name" href={`/runs/${run.id}`}>
          {title} <code>{shortId(run.id)}</code>
        </a>
      </NameField>
      {run.sweep && (
        <a class="badge sweep-link" href={`/sweeps/${run.sweep}`} aria-label={text.sweepOf(name)}>
          {text.sweep}
        </a>
      )}
      {forceFreeShare(run.spec) === "none" && <NotForceFree />}
    </>
  );
}

/** Notes on a run that waits, compiles, failed or will be purged. */
function RowNotes({ run }: { run: Run }) {
  return (
    <>
      {run.status === "running" && run.generation === 0 && (
        <span class="row-note quiet">{text.compiling}</span>
      )}
      {run.purge_at && <span class="row-note gone quiet">{text.purged(dateTime(run.purge_at))}</span>}
      {run.waiting_reason && <span class="row-note reason quiet">{run.waiting_reason}</span>}
      {run.error && <span class="row-note wrong-text">{run.error}</span>}
      {run.warning && <span class="row-note warning-text">{run.warning}</span>}
    </>
  );
}

function RowActions({ run, title, name }: Omit<PartProps, "readOnly">) {
  const mayCreate = useRefusal() === null;
  const mayChange = useRefusal(run) === null;
  return (
    <td class="row-actions">
      <span class="actions">
        {mayChange && run.deleted_at && (
          <button onClick={() => void restore(run.id)} aria-label={text.restoreRun(name)}>
            {text.restore}
          </button>
        )}
        {mayChange && !run.deleted_at && <CommandButtons {...{ run, title, name }} />}
        {mayCreate && (
          <a class="button" href={`/new?from=${run.id}`} aria-label={text.cloneRun(name)}>
            {text.clone}
          </a>
        )}
      </span>
    </td>
  );
}

interface LabelProps {
  run: Run;
  name: string;
  readOnly: boolean;
}

const MAX_TAGS = 20;

function TagList({ run, name, readOnly, known }: LabelProps & { known: string }) {
  const { open, setOpen, button } = useDisclosure();
  const done = (tag: string | null) => {
    setOpen(false);
    if (tag) addTag(run, tag);
  };
  return (
    <span class="tags row">
      {run.tags.map((tag) => (
        <span key={tag} class="tag">
          <button title={text.runsTagged(tag)} onClick={() => setQuery({ tag })}>
            {tag}
          </button>
          {!readOnly && (
            <button aria-label={text.removeTag(tag, name)} onClick={() => void removeTag(run, tag)}>
              ✕
            </button>
          )}
        </span>
      ))}
      {open && <InlineText label={text.newTag(name)} value="" limit={50} list={known} onDone={done} />}
      {!open && !readOnly && run.tags.length < MAX_TAGS && (
        <button
          ref={button}
          class="plain small-button"
          aria-label={text.addTag(name)}
          onClick={() => setOpen(true)}
        >
          {text.addTagShort}
        </button>
      )}
    </span>
  );
}

function NoteField({ run, name, readOnly }: LabelProps) {
  const { open, setOpen, button } = useDisclosure();
  const done = (note: string | null) => {
    setOpen(false);
    if (note === null || note === (run.note ?? "")) return;
    if (note) void editRun(run.id, { note });
    else void removeNote(run);
  };
  if (readOnly) return run.note ? <span class="note quiet small">{run.note}</span> : null;
  if (open) {
    return <InlineText label={text.noteOn(name)} value={run.note ?? ""} limit={10_000} long onDone={done} />;
  }
  return (
    <button
      ref={button}
      class={`plain small-button note ${run.note ? "" : "none"}`}
      aria-label={run.note ? text.editNote(name, run.note) : text.addNote(name)}
      title={run.note ?? undefined}
      onClick={() => setOpen(true)}
    >
      {run.note ?? text.addNoteShort}
    </button>
  );
}
