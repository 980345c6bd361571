/** Particles that drift in live water. */

import type { Replay } from "../../decode/replay";
import { type Particles, initialPositions, velocityAt } from "../../replay/tracers";

/** Cells per particle. */
const CELLS = 1.5;

export class Dye implements Particles {
  private readonly places: Float32Array;

  /** `replay` is the present state, as one frame. */
  constructor(public replay: Replay) {
    this.places = initialPositions(...replay.header.size, CELLS);
  }

  at(): Float32Array {
    return this.places;
  }

  /** Drift for some steps with the water of the next state. */
  drift(replay: Replay, steps: number): void {
    this.replay = replay;
    for (let i = 0; i < this.places.length; i += 2) {
      const [u, v] = velocityAt(replay, 0, this.places[i]!, this.places[i + 1]!);
      this.places[i]! += steps * u;
      this.places[i + 1]! += steps * v;
    }
  }
}
