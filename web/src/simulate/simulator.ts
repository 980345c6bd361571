/** The simulator of the page: the native kernel as WebAssembly, in a web worker of its own. */

import type { Evaluated } from "./evaluate";
import { evaluator, kernelBytes } from "./source";

export interface Order {
  module: WebAssembly.Module;
  /** The file of the inputs. */
  inputs: ArrayBuffer;
}

/** The share that is done, or the end. */
export type Answer = { share: number } | { found: Evaluated } | { error: string };

/** The compiled kernel. */
export const kernelModule = async (signal?: AbortSignal): Promise<WebAssembly.Module> =>
  WebAssembly.compile(await kernelBytes(signal));

/** Evaluate a creature; aborting ends the worker. */
export async function simulate(
  inputs: ArrayBuffer,
  progress: (share: number) => void,
  signal: AbortSignal,
): Promise<Evaluated> {
  const module = await kernelModule(signal);
  const worker = evaluator();
  try {
    return await new Promise((resolve, reject) => {
      signal.addEventListener("abort", () => reject(signal.reason));
      worker.onerror = ({ message }) => reject(new Error(message));
      worker.onmessage = ({ data }: MessageEvent<Answer>) => {
        if ("share" in data) progress(data.share);
        else if ("found" in data) resolve(data.found);
        else reject(new Error(data.error));
      };
      const order: Order = { module, inputs };
      worker.postMessage(order, [inputs]);
    });
  } finally {
    worker.terminate();
  }
}
