/** Tags and note of a run, edited in place. */

import type { Run } from "../api/types";
import { addTag, editRun, removeNote, removeTag } from "../store/commands";
import { setQuery } from "../store/router";
import { InlineText } from "../ui/InlineText";
import { useDisclosure } from "../ui/disclosure";
import { text } from "./text";

interface Props {
  run: Run;
  name: string;
  fixed: boolean;
}

const MAX_TAGS = 20;

export function TagList({ run, name, fixed, known }: Props & { known: string }) {
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
          {!fixed && (
            <button aria-label={text.removeTag(tag, name)} onClick={() => removeTag(run, tag)}>
              ✕
            </button>
          )}
        </span>
      ))}
      {open && <InlineText label={text.newTag(name)} value="" limit={50} list={known} onDone={done} />}
      {!open && !fixed && run.tags.length < MAX_TAGS && (
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

export function NoteField({ run, name, fixed }: Props) {
  const { open, setOpen, button } = useDisclosure();
  const done = (note: string | null) => {
    setOpen(false);
    if (note === null || note === (run.note ?? "")) return;
    if (note) void editRun(run.id, { note });
    else removeNote(run);
  };
  if (fixed) return run.note ? <span class="note quiet small">{run.note}</span> : null;
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
