/** Where the kernel and the scripts of web workers come from: the server. A saved page has its own. */

/** The address of the kernel; without a compiler, the page is built without one. */
const [KERNEL] = Object.values(
  import.meta.glob<string>("./*.wasm", { query: "?url", import: "default", eager: true }),
);

export const isInstalled = KERNEL !== undefined;

export async function kernelBytes(signal?: AbortSignal): Promise<ArrayBuffer> {
  return (await fetch(KERNEL!, { signal })).arrayBuffer();
}

export const evaluator = () => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
export const swimmer = () => new Worker(new URL("./swimWorker.ts", import.meta.url), { type: "module" });
