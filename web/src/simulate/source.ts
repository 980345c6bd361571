/** The kernel and the script of its web workers, from the server; a saved page has its own. */

import { text } from "./text";

/** The address of the kernel; without a compiler, the page is built without one. */
const [KERNEL] = Object.values(
  import.meta.glob<string>("./*.wasm", { query: "?url", import: "default", eager: true }),
);

export const isInstalled = KERNEL !== undefined;

export async function kernelBytes(signal?: AbortSignal): Promise<ArrayBuffer> {
  const response = await fetch(KERNEL!, { signal });
  if (!response.ok) throw new Error(text.noKernel(response.status));
  return response.arrayBuffer();
}

export const startWorker = () => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
