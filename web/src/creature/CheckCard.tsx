/** A check of a creature that the server computes on order, and its card: verdict, button, progress, result. */

import type { ComponentChildren } from "preact";
import { Card } from "../ui/Page";
import { text } from "./text";
import { useState } from "preact/hooks";
import type { OrNever } from "../api/client";
import { messageOf } from "../api/problem";
import { usePolled } from "../store/polling";

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

export interface Check<T> {
  /** Null while it is not known, and without an order. */
  result: T | null;
  /** Nobody has ordered it. */
  never: boolean;
  running: boolean;
  note: string | null;
  error: string | null;
  start: () => Promise<void>;
}

/** The result of a check, and a function that orders it. */
export function useCheck<T>(
  sha: string,
  read: (sha: string) => Promise<OrNever<T>>,
  order: (sha: string) => Promise<unknown>,
): Check<T> {
  const [orders, setOrders] = useState(0);
  const [starting, setStarting] = useState(false);
  const [failed, setFailed] = useState<string | null>(null);
  const { value, answered, note, error } = usePolled(() => read(sha), [sha, orders]);
  const start = async () => {
    setFailed(null);
    setStarting(true);
    try {
      await order(sha);
      setOrders((count) => count + 1);
    } catch (reason) {
      setFailed(messageOf(reason));
    }
    setStarting(false);
  };
  const known = starting ? null : value;
  return {
    result: known === "never" ? null : known,
    never: known === "never",
    running: starting || (answered && value === null),
    note,
    error: failed ?? error,
    start,
  };
}
