/** Creatures that swim on in a web worker. */

import { kernelModule } from "./simulator";
import { swimmer } from "./source";
import type { Frame, Stage } from "./swim";

export interface Begin {
  module: WebAssembly.Module;
  /** The file of the inputs. */
  inputs: ArrayBuffer;
}

export interface Push {
  /** In cells from the first creature's mean position. */
  away: [number, number];
  /** In cells a step. */
  velocity: [number, number];
}

export interface Pull {
  /** One of the nodes that have grown. */
  node: number;
  /** Where to, in cells from the first creature's mean position. */
  away: [number, number];
}

export interface Steps {
  steps: number;
  viscosity: number;
  /** Of the stroke, relative to the recorded one. */
  speed: number;
  pushes: Push[];
  pull: Pull | null;
  /** Files of the inputs of creatures that join. */
  joining: ArrayBuffer[];
}

export interface Advanced {
  frame: Frame;
  /** Why a creature could not join. */
  refused: string | null;
}

export type Event = { stage: Stage } | Advanced | { error: string };

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

  async advance(steps: Steps): Promise<Advanced> {
    return (await answered(this.worker, steps)) as Advanced;
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
