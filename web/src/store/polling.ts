/** Hooks that slow down values, repeat requests or listen to the window; polling. */

import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { messageOf, isTransient } from "../api/problem";

/** The latest value, passed on at most once per interval. */
export function useThrottled<T>(value: T, interval = 2000): T {
  const [passed, setPassed] = useState(value);
  const last = useRef(-Infinity);
  useEffect(() => {
    if (Object.is(value, passed)) return;
    const wait = Math.max(0, last.current + interval - performance.now());
    const timer = setTimeout(() => {
      last.current = performance.now();
      setPassed(() => value);
    }, wait);
    return () => clearTimeout(timer);
  }, [value, passed]);
  return passed;
}

/** Call back with a value that has not changed for a while; null is ignored. */
export function useDebounced<T>(value: T | null, after: number, call: (value: T) => void): void {
  useEffect(() => {
    if (value === null) return;
    const timer = setTimeout(() => call(value), after);
    return () => clearTimeout(timer);
  }, [value]);
}

/** Listen to events that reach the window as soon as a component is shown. */
export function useListener<E extends Event>(type: string, listener: (event: E) => void): void {
  useLayoutEffect(() => {
    window.addEventListener(type, listener as EventListener);
    return () => window.removeEventListener(type, listener as EventListener);
  });
}

/** A counter that increases in every interval while the tab is visible. */
export function useTick(interval: number, enabled = true): number {
  const [tick, setTick] = useState(0);
  useEffect(() => {
    if (!enabled) return;
    const count = () => document.visibilityState === "visible" && setTick((old) => old + 1);
    const timer = setInterval(count, interval);
    document.addEventListener("visibilitychange", count);
    return () => {
      clearInterval(timer);
      document.removeEventListener("visibilitychange", count);
    };
  }, [interval, enabled]);
  return tick;
}

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
  let active = true;
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
      (value) => active && answer(value),
      (reason) => active && fail(reason),
    );
  void request();
  return () => {
    active = false;
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

/** The value of a resource that is polled; `ask` is null while it is not polled. */
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
