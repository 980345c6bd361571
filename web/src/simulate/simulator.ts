/** The simulator of the page: the native kernel as WebAssembly, in a web worker of its own. */

import type { Evaluated } from "./evaluate";

export interface Order {
  module: WebAssembly.Module;
  /** The file of the inputs. */
  inputs: ArrayBuffer;
}

/** The share that is done, or the end. */
export type Answer = { share: number } | { found: Evaluated } | { error: string };

/** The address of the kernel; without a compiler, the page is built without one. */
const [KERNEL] = Object.values(
  import.meta.glob<string>("./*.wasm", { query: "?url", import: "default", eager: true }),
);

export const isInstalled = KERNEL !== undefined;

/** The compiled kernel. */
export async function kernelModule(signal?: AbortSignal): Promise<WebAssembly.Module> {
  const answer = await fetch(KERNEL!, { signal });
  return WebAssembly.compile(await answer.arrayBuffer());
}

/** Evaluate a creature; aborting ends the worker. */
export async function simulate(
  inputs: ArrayBuffer,
  progress: (share: number) => void,
  signal: AbortSignal,
): Promise<Evaluated> {
  const module = await kernelModule(signal);
  const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
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
