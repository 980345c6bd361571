/** A creature that swims on in a web worker. */

import { kernelModule } from "./simulator";
import { swimmer } from "./source";
import type { Frame, Stage } from "./swim";

export interface Begin {
  module: WebAssembly.Module;
  /** The file of the inputs. */
  inputs: ArrayBuffer;
}

export interface Push {
  /** In cells from the creature's mean position. */
  away: [number, number];
  /** In cells a step. */
  velocity: [number, number];
}

export interface Steps {
  steps: number;
  viscosity: number;
  pushes: Push[];
}

export type Event = { stage: Stage } | { frame: Frame } | { error: string };

export class Live {
  private constructor(
    private readonly worker: Worker,
    readonly stage: Stage,
  ) {}

  /** Evaluate the creature, which then stands at the end of its simulation. */
  static async begin(inputs: ArrayBuffer): Promise<Live> {
    const module = await kernelModule();
    const worker = swimmer();
    try {
      const event = await answered(worker, { module, inputs });
      return new Live(worker, (event as { stage: Stage }).stage);
    } catch (error) {
      worker.terminate();
      throw error;
    }
  }

  async advance(steps: Steps): Promise<Frame> {
    return ((await answered(this.worker, steps)) as { frame: Frame }).frame;
  }

  end(): void {
    this.worker.terminate();
  }
}

function answered(worker: Worker, order: Begin | Steps): Promise<Event> {
  return new Promise((resolve, reject) => {
    worker.onerror = ({ message }) => reject(new Error(message));
    worker.onmessage = ({ data }: MessageEvent<Event>) => {
      if ("error" in data) reject(new Error(data.error));
      else resolve(data);
    };
    worker.postMessage(order);
  });
}
