/** Asking the server again and again until it has what is being made. */

import { messageOf, isTransient } from "../api/problem";

export const POLL_MS = 1000;

interface PollHandlers<T> {
  value: (value: T) => void;
  /** Why the last try had no answer, though the next may; null once one came. */
  note: (text: string | null) => void;
  error: (text: string) => void;
}

/** Asks until the answer is not null, or a failure that stays; returns what stops it. */
export function poll<T>(ask: () => Promise<T | null>, handlers: PollHandlers<T>): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let wanted = true;
  const turn = async () => {
    const outcome = await ask().then(
      (value) => () => hear(value),
      (reason) => () => fail(reason),
    );
    if (wanted) outcome();
  };
  const again = () => {
    timer = setTimeout(turn, POLL_MS);
  };
  const hear = (value: T | null) => {
    handlers.note(null);
    if (value === null) again();
    else handlers.value(value);
  };
  const fail = (reason: unknown) => {
    if (!isTransient(reason)) return handlers.error(messageOf(reason));
    handlers.note(messageOf(reason));
    again();
  };
  void turn();
  return () => {
    wanted = false;
    clearTimeout(timer);
  };
}
