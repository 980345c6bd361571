/** What moves a replay: the screen's own pace, and keys. */

import type { RefObject } from "preact";
import { useEffect, useRef } from "preact/hooks";

/** Calls back with the seconds since the last frame of the screen, while it runs. */
export function useClock(running: boolean, tick: (seconds: number) => void): void {
  const latest = useRef<typeof tick | null>(tick);
  // Effects are cleaned up after the next frame: a clock that was stopped must not tick in it.
  latest.current = running ? tick : null;
  useEffect(() => {
    if (!running) return;
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now) {
      // A tab that was hidden goes on where it was.
      latest.current?.(Math.min(0.1, Math.max(0, now - last) / 1000));
      last = now;
      frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [running]);
}

/** What has a use of its own for these keys, or for text. */
const OWN = "select, textarea, [contenteditable], input:not([type=range], [type=checkbox])";
const PRESSED = "button, a, summary, input:not([type=range])";

/** Whether a key pressed on a target is a player's: its space bar plays from anywhere on the
 * page, and its other keys work within it alone, so that they cannot be pressed by mistake. */
export function keyAction(key: string, target: Element, player: Element | null): boolean {
  if (target.closest(OWN)) return false;
  return key === " " ? !target.closest(PRESSED) : player?.contains(target) === true;
}

/** Keys of a player, each with what it does. */
export function useKeys(player: RefObject<Element | null>, keys: Record<string, () => void>): void {
  const latest = useRef(keys);
  latest.current = keys;
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
      const action = latest.current[event.key];
      if (!action || !keyAction(event.key, event.target as Element, player.current)) return;
      event.preventDefault();
      action();
    };
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, []);
}
