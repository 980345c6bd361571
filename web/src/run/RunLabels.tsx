/** Name, tags and note of a run, edited in place. */

import type { ComponentChildren } from "preact";
import { useRef, useState } from "preact/hooks";
import type { Run } from "../api/types";
import { InlineText } from "../ui/InlineText";
import { text } from "./text";
import "./labels.css";

interface NameProps {
  of: { name: string | null };
  title: string;
  /** True if the name cannot be changed. */
  fixed: boolean;
  onName: (name: string | null) => void;
  children: ComponentChildren;
}

/** A name, and a button that makes it a field. */
export function NameField({ of, title, fixed, onName, children }: NameProps) {
  const [open, setOpen, button] = useEditing();
  const done = (name: string | null) => {
    setOpen(false);
    if (name !== null && name !== (of.name ?? "") && name !== title) onName(name || null);
  };
  if (fixed) return <>{children}</>;
  if (open) return <InlineText label={text.nameOf(title)} value={title} limit={200} onDone={done} />;
  return (
    <>
      {children}
      <button
        ref={button}
        class="plain small-button"
        aria-label={text.renameRun(title)}
        title={text.rename}
        onClick={() => setOpen(true)}
      >
        ✎
      </button>
    </>
  );
}

interface TagsProps {
  run: Run;
  name: string;
  fixed: boolean;
  /** Id of the `datalist` of known tags. */
  known?: string;
  onPick: (tag: string) => void;
  onAdd: (tag: string) => void;
  onRemove: (tag: string) => void;
}

const MAX_TAGS = 20;

export function TagList({ run, name, fixed, known, onPick, onAdd, onRemove }: TagsProps) {
  const [open, setOpen, button] = useEditing();
  const done = (tag: string | null) => {
    setOpen(false);
    if (tag) onAdd(tag);
  };
  return (
    <span class="tags">
      {run.tags.map((tag) => (
        <span key={tag} class="tag">
          <button title={text.runsTagged(tag)} onClick={() => onPick(tag)}>
            {tag}
          </button>
          {!fixed && (
            <button aria-label={text.removeTag(tag, name)} onClick={() => onRemove(tag)}>
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
          {text.tag}
        </button>
      )}
    </span>
  );
}

interface NoteProps {
  run: Run;
  name: string;
  fixed: boolean;
  onNote: (note: string) => void;
  onRemove: () => void;
}

export function NoteField({ run, name, fixed, onNote, onRemove }: NoteProps) {
  const [open, setOpen, button] = useEditing();
  const done = (note: string | null) => {
    setOpen(false);
    if (note === null || note === (run.note ?? "")) return;
    if (note) onNote(note);
    else onRemove();
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
      {run.note ?? text.note}
    </button>
  );
}

/** State of an editor; its button gets the focus back when it closes. */
function useEditing() {
  const button = useRef<HTMLButtonElement>(null);
  const [open, setOpen] = useState(false);
  const change = (next: boolean) => {
    setOpen(next);
    if (!next) setTimeout(() => document.activeElement === document.body && button.current?.focus());
  };
  return [open, change, button] as const;
}
