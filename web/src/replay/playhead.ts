/** The playhead of a replay: its time and state, which all parts of a page share. */

import { useEffect, useState } from "preact/hooks";
import { prefersReducedMotion } from "../ui/canvas";

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

export const newPlayhead = () => new Playhead(!prefersReducedMotion());

/** Redraw a component when the playhead moves, starts or stops. */
export function usePlayhead(playhead: Playhead): Playhead {
  const [, draw] = useState(0);
  useEffect(() => playhead.listen(() => draw((n) => n + 1)), [playhead]);
  return playhead;
}
