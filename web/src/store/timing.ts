/** Hooks that slow down values, repeat requests or listen to the window. */

import { useEffect, useRef, useState } from "preact/hooks";

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

/** Listen to events that reach the window while a component is shown. */
export function useListener<E extends Event>(type: string, listener: (event: E) => void): void {
  useEffect(() => {
    window.addEventListener(type, listener as EventListener);
    return () => window.removeEventListener(type, listener as EventListener);
  });
}

/** A counter that increases in every interval while the tab is visible. */
export function useTick(interval: number, wanted = true): number {
  const [tick, setTick] = useState(0);
  useEffect(() => {
    if (!wanted) return;
    const count = () => document.visibilityState === "visible" && setTick((old) => old + 1);
    const timer = setInterval(count, interval);
    document.addEventListener("visibilitychange", count);
    return () => {
      clearInterval(timer);
      document.removeEventListener("visibilitychange", count);
    };
  }, [interval, wanted]);
  return tick;
}
