/** Ask whether a file is ready or exists, without reading it. */

import { problemOf } from "./problem";
import { noteStatus } from "./signedOut";

/** True once a rendering is there, null while it is made; nothing of it is read. */
export async function renderingReady(url: string): Promise<true | null> {
  return (await readHead(url)).status === 202 ? null : true;
}

/** Throws the reason where a file cannot be had; nothing of it is read. */
export async function checkFile(url: string): Promise<void> {
  await readHead(url);
}

async function readHead(url: string): Promise<Response> {
  const stop = new AbortController();
  const response = await fetch(url, { signal: stop.signal });
  noteStatus(response.status);
  if (!response.ok) throw problemOf(response.status, await response.json().catch(() => null));
  stop.abort();
  return response;
}
