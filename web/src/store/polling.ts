/** Poll the server until it has prepared a resource. */

import { useEffect, useState } from "preact/hooks";
import { messageOf, isTransient } from "../api/problem";

export const POLL_MS = 1000;

interface PollHandlers<T> {
  value: (value: T) => void;
  /** A temporary failure of the last request; null after an answer. */
  note: (text: string | null) => void;
  error: (text: string) => void;
}

/** Repeat `ask` until it returns a value or fails permanently; return a function that stops it. */
export function poll<T>(ask: () => Promise<T | null>, handlers: PollHandlers<T>): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let wanted = true;
  const repeat = () => {
    timer = setTimeout(request, POLL_MS);
  };
  const answer = (value: T | null) => {
    handlers.note(null);
    if (value === null) repeat();
    else handlers.value(value);
  };
  const fail = (reason: unknown) => {
    if (!isTransient(reason)) return handlers.error(messageOf(reason));
    handlers.note(messageOf(reason));
    repeat();
  };
  const request = () =>
    ask().then(
      (value) => wanted && answer(value),
      (reason) => wanted && fail(reason),
    );
  void request();
  return () => {
    wanted = false;
    clearTimeout(timer);
  };
}

interface Polled<T> {
  value: T | null;
  /** True once the server has answered. */
  answered: boolean;
  note: string | null;
  error: string | null;
}

const NOTHING = { value: null, answered: false, note: null, error: null };

/** The value of a resource that is polled; `ask` is null while it is not wanted. */
export function usePolled<T>(ask: (() => Promise<T | null>) | null, inputs: unknown[]): Polled<T> {
  const [state, setState] = useState<Polled<T>>(NOTHING);
  useEffect(() => {
    setState(NOTHING);
    if (!ask) return;
    const change = (part: Partial<Polled<T>>) => setState((old) => ({ ...old, ...part }));
    return poll(ask, {
      value: (value) => change({ value }),
      note: (note) => change(note === null ? { note, answered: true } : { note }),
      error: (error) => change({ error }),
    });
  }, inputs);
  return state;
}
