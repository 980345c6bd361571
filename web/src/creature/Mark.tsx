/** A sign with a word for screen readers: good or bad. */

export function Mark({ good, word }: { good: boolean; word: string }) {
  return (
    <span class={`mark-word ${good ? "right" : "wrong"}`} title={word}>
      <span aria-hidden="true">{good ? "✓" : "✕"}</span>
      <span class="unseen">{word}</span>
    </span>
  );
}
