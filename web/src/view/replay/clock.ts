/** What moves a replay: the screen's own pace, and the space bar. */

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

export function useSpaceBar(toggle: () => void): void {
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      const busy = target.closest("button, select, a, textarea, summary, input:not([type=range])");
      if (event.key !== " " || busy) return;
      event.preventDefault();
      toggle();
    };
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, []);
}
