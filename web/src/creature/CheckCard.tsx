/** A card that runs a check of a creature: its verdict, a button, its progress and its result. */

import type { ComponentChildren } from "preact";
import { Card } from "../ui/Page";
import { text } from "./text";

interface Props {
  name: string;
  title: string;
  /** A badge; null without a result. */
  verdict: ComponentChildren;
  button: string | null;
  onStart: () => void;
  /** Text while the check runs; null if it does not run. */
  running: string | null;
  note: string | null;
  error: string | null;
  children: ComponentChildren;
}

export function CheckCard({ name, title, verdict, button, onStart, running, note, error, children }: Props) {
  return (
    <Card
      id={name}
      title={title}
      kind={name}
      note={verdict}
      actions={button && <button onClick={onStart}>{button}</button>}
    >
      {running && !error && (
        <p class="quiet" role="status">
          {note ? text.retrying(note) : running}
        </p>
      )}
      {error && <p class="banner wrong">{error}</p>}
      {children}
    </Card>
  );
}
