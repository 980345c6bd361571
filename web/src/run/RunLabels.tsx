/** What people say of a run, changed where it stands: its name, its tags, a note. */

import type { ComponentChildren } from "preact";
import { useRef, useState } from "preact/hooks";
import type { Run } from "../api/types";
import { InlineText } from "../ui/InlineText";
import "./labels.css";

interface NameProps {
  of: { name: string | null };
  title: string;
  /** Whether it is not ours to change. */
  fixed: boolean;
  onName: (name: string | null) => void;
  children: ComponentChildren;
}

/** A name, and a button that makes it a field. */
export function NameField({ of, title, fixed, onName, children }: NameProps) {
  const [open, setOpen, button] = useEditing();
  const done = (text: string | null) => {
    setOpen(false);
    if (text !== null && text !== (of.name ?? "") && text !== title) onName(text || null);
  };
  if (fixed) return <>{children}</>;
  if (open) return <InlineText label={`Name of ${title}`} value={title} limit={200} onDone={done} />;
  return (
    <>
      {children}
      <button
        ref={button}
        class="plain small-button"
        aria-label={`Rename ${title}`}
        title="Rename"
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
  /** The id of a list of tags that others have. */
  known?: string;
  onPick: (tag: string) => void;
  onAdd: (tag: string) => void;
  onRemove: (tag: string) => void;
}

const MAX_TAGS = 20;

export function TagList({ run, name, fixed, known, onPick, onAdd, onRemove }: TagsProps) {
  const [open, setOpen, button] = useEditing();
  const done = (text: string | null) => {
    setOpen(false);
    if (text) onAdd(text);
  };
  return (
    <span class="tags">
      {run.tags.map((tag) => (
        <span key={tag} class="tag">
          <button title={`Runs tagged ${tag}`} onClick={() => onPick(tag)}>
            {tag}
          </button>
          {!fixed && (
            <button aria-label={`Remove the tag ${tag} from ${name}`} onClick={() => onRemove(tag)}>
              ✕
            </button>
          )}
        </span>
      ))}
      {open && <InlineText label={`New tag of ${name}`} value="" limit={50} list={known} onDone={done} />}
      {!open && !fixed && run.tags.length < MAX_TAGS && (
        <button
          ref={button}
          class="plain small-button"
          aria-label={`Add a tag to ${name}`}
          onClick={() => setOpen(true)}
        >
          + tag
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
  const done = (text: string | null) => {
    setOpen(false);
    if (text === null || text === (run.note ?? "")) return;
    if (text) onNote(text);
    else onRemove();
  };
  if (fixed) return run.note ? <span class="note quiet small">{run.note}</span> : null;
  if (open) {
    return <InlineText label={`Note on ${name}`} value={run.note ?? ""} limit={10_000} long onDone={done} />;
  }
  return (
    <button
      ref={button}
      class={`plain small-button note ${run.note ? "" : "none"}`}
      aria-label={run.note ? `Change the note on ${name}: ${run.note}` : `Add a note to ${name}`}
      title={run.note ?? undefined}
      onClick={() => setOpen(true)}
    >
      {run.note ?? "+ note"}
    </button>
  );
}

/** Whether a field is open; the button that opened it has the focus again afterwards. */
function useEditing() {
  const button = useRef<HTMLButtonElement>(null);
  const [open, setOpen] = useState(false);
  const change = (next: boolean) => {
    setOpen(next);
    if (!next) setTimeout(() => document.activeElement === document.body && button.current?.focus());
  };
  return [open, change, button] as const;
}
