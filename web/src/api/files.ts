/** Ask whether a file is ready or exists, without reading it. */

import { problemOf } from "./problem";
import { noteStatus } from "./signedOut";

/** True once a rendering is there, null while it is made; nothing of it is read. */
export async function proveRendering(url: string): Promise<true | null> {
  return (await proved(url)).status === 202 ? null : true;
}

/** Throws the reason where a file cannot be had; nothing of it is read. */
export async function proveFile(url: string): Promise<void> {
  await proved(url);
}

async function proved(url: string): Promise<Response> {
  const stop = new AbortController();
  const response = await fetch(url, { signal: stop.signal });
  noteStatus(response.status);
  if (!response.ok) throw problemOf(response.status, await response.json().catch(() => null));
  stop.abort();
  return response;
}
