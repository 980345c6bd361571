/** The clock of animations, and the keys of a player. */

import type { RefObject } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { prefersReducedMotion } from "../ui/canvas";
import { TEXT_FIELDS } from "../ui/forms";

/** While running, call `tick` in every frame with the seconds since the last one. */
export function useClock(running: boolean, tick: (seconds: number) => void): void {
  const latest = useRef<typeof tick | null>(tick);
  // Effects are cleaned up after the next frame; a stopped clock must not tick in it.
  latest.current = running ? tick : null;
  useEffect(() => {
    if (!running) return;
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now) {
      // A tab that was hidden continues where it was.
      latest.current?.(Math.min(0.1, Math.max(0, now - last) / 1000));
      last = now;
      frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [running]);
}

/** Simulated steps per second in small previews, the same for all creatures: some two seconds a stroke. */
export const STEPS_PER_SECOND = 200;

/** Draw after each render, and in every frame while running; `steps` are the simulated steps so far. */
export function useSteps(running: boolean, draw: (steps: number) => void): void {
  const steps = useRef(0);
  useClock(running && !prefersReducedMotion(), (seconds) => {
    steps.current += seconds * STEPS_PER_SECOND;
    draw(steps.current);
  });
  useEffect(() => draw(steps.current));
}

/** Elements that the space bar presses. */
const BUTTONS = "button, a, summary, input:not([type=range])";

/** True if a player handles a key: the space bar from anywhere on the page, others within it. */
export function handlesKey(key: string, target: Element, player: Element | null): boolean {
  if (target.closest(TEXT_FIELDS)) return false;
  return key === " " ? !target.closest(BUTTONS) : player?.contains(target) === true;
}

export function useKeys(player: RefObject<Element | null>, keys: Record<string, () => void>): void {
  const latest = useRef(keys);
  latest.current = keys;
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
      const action = latest.current[event.key];
      if (!action || !handlesKey(event.key, event.target as Element, player.current)) return;
      event.preventDefault();
      action();
    };
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, []);
}
