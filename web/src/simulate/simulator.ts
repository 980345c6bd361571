/** The simulator of the page: the native kernel as WebAssembly, in a web worker for each creature. */

import type { Evaluated } from "./evaluate";
import { kernelBytes, startWorker } from "./source";
import type { Frame, Stage } from "./swim";

export interface Begin {
  module: WebAssembly.Module;
  /** The file of the inputs. */
  inputs: ArrayBuffer;
  /** True if the creature swims on after its evaluation. */
  live: boolean;
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
  /** The end of the pull, in cells from the first creature's mean position. */
  away: [number, number];
}

export interface Steps {
  steps: number;
  viscosity: number;
  /** Speed of the stroke, relative to the recorded one. */
  speed: number;
  pushes: Push[];
  pull: Pull | null;
  /** Files of the inputs of creatures that join. */
  joining: ArrayBuffer[];
}

export interface Advanced {
  frame: Frame;
  /** The reason why a creature could not join. */
  refused: string | null;
}

/** The share that is done, or the end of an order. */
export type Answer =
  { share: number } | { found: Evaluated } | { stage: Stage } | Advanced | { error: string };

const kernelModule = async (signal?: AbortSignal): Promise<WebAssembly.Module> =>
  WebAssembly.compile(await kernelBytes(signal));

/** Send an order; return its last answer. */
function answered<T>(worker: Worker, order: Begin | Steps, progress?: (share: number) => void): Promise<T> {
  return new Promise((resolve, reject) => {
    worker.onerror = ({ message }) => reject(new Error(message));
    worker.onmessage = ({ data }: MessageEvent<Answer>) => {
      if ("share" in data) progress?.(data.share);
      else if ("error" in data) reject(new Error(data.error));
      else resolve(data as T);
    };
    worker.postMessage(order);
  });
}

/** Evaluate a creature; aborting ends the worker. */
export async function simulate(
  inputs: ArrayBuffer,
  progress: (share: number) => void,
  signal: AbortSignal,
): Promise<Evaluated> {
  const module = await kernelModule(signal);
  const worker = startWorker();
  const aborted = new Promise<never>((_, reject) => {
    signal.addEventListener("abort", () => reject(signal.reason as Error));
  });
  try {
    const done = answered<{ found: Evaluated }>(worker, { module, inputs, live: false }, progress);
    return (await Promise.race([done, aborted])).found;
  } finally {
    worker.terminate();
  }
}

/** Creatures that swim on in a web worker. */
export class Live {
  private constructor(
    private readonly worker: Worker,
    readonly stage: Stage,
  ) {}

  /** Evaluate the creature, which then stands at the end of its simulation. */
  static async begin(inputs: ArrayBuffer): Promise<Live> {
    const module = await kernelModule();
    const worker = startWorker();
    try {
      const { stage } = await answered<{ stage: Stage }>(worker, { module, inputs, live: true });
      return new Live(worker, stage);
    } catch (error) {
      worker.terminate();
      throw error;
    }
  }

  advance(steps: Steps): Promise<Advanced> {
    return answered(this.worker, steps);
  }

  end(): void {
    this.worker.terminate();
  }
}
