/** Waits between a value and what is made of it. */

import { useEffect, useRef, useState } from "preact/hooks";

/** How often what changes all the time is asked for, at most. */
const THROTTLE_MS = 2000;

/** A value that is let through now and then, the last one always. */
export function useThrottled<T>(value: T, every = THROTTLE_MS): T {
  const [paced, setPaced] = useState(value);
  const last = useRef(-Infinity);
  useEffect(() => {
    if (Object.is(value, paced)) return;
    const wait = Math.max(0, last.current + every - performance.now());
    const timer = setTimeout(() => {
      last.current = performance.now();
      setPaced(() => value);
    }, wait);
    return () => clearTimeout(timer);
  }, [value, paced]);
  return paced;
}

/** Hears of a value that has stayed the same for a moment; of none it does not hear. */
export function useDebounced<T>(value: T | null, after: number, hear: (value: T) => void): void {
  useEffect(() => {
    if (value === null) return;
    const timer = setTimeout(() => hear(value), after);
    return () => clearTimeout(timer);
  }, [value]);
}
