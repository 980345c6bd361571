/** The clock of animations, the playhead that all parts of a page share, and the keys of a player. */

import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { useListener } from "../store/polling";
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
  useListener("keydown", (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const action = keys[event.key];
    if (!action || !handlesKey(event.key, event.target as Element, player.current)) return;
    event.preventDefault();
    action();
  });
}

/** The time of a replay, and whether it plays. */
export class Playhead {
  /** In frames; may be a fraction. */
  time = 0;
  playing: boolean;
  private readonly listeners = new Set<() => void>();

  constructor(playing: boolean) {
    this.playing = playing;
  }

  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  move(time: number): void {
    this.time = time;
    this.notify();
  }

  play(playing: boolean): void {
    this.playing = playing;
    this.notify();
  }

  /** Stop at a time. */
  scrub(time: number): void {
    this.playing = false;
    this.move(time);
  }

  /** Stop at the next or previous frame. */
  step(by: 1 | -1, last: number): void {
    const whole = by > 0 ? Math.floor(this.time + 1e-6) + 1 : Math.ceil(this.time - 1e-6) - 1;
    this.scrub(Math.min(last, Math.max(0, whole)));
  }

  private notify(): void {
    for (const listener of [...this.listeners]) listener();
  }
}

/** A playhead that moves; for people who prefer no motion, one that stands at a frame. */
export function newPlayhead(still = 0): Playhead {
  const playhead = new Playhead(!prefersReducedMotion());
  if (!playhead.playing) playhead.time = still;
  return playhead;
}

/** Redraw a component when the playhead moves, starts or stops. */
export function usePlayhead(playhead: Playhead): Playhead {
  const [, draw] = useState(0);
  useEffect(() => playhead.listen(() => draw((n) => n + 1)), [playhead]);
  return playhead;
}
