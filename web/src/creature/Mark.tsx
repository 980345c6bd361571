/** Signs of what is good or bad, and whether numbers are those of a record. */

import { text } from "./text";

/** A sign with a word for screen readers. */

export function Mark({ good, word }: { good: boolean; word: string }) {
  return (
    <span class={`mark-word ${good ? "right" : "wrong"}`} title={word}>
      <span aria-hidden="true">{good ? "✓" : "✕"}</span>
      <span class="unseen">{word}</span>
    </span>
  );
}

/** A badge: every number equals the recorded one, or some differ. */
export function Agreement({ same }: { same: boolean }) {
  return <span class={`badge ${same ? "finished" : "paused"}`}>{same ? text.identical : text.differs}</span>;
}
