/** The HTTP client: it sends the share of the page, throws problems, and reports a missing sign-in. */

import createClient from "openapi-fetch";
import { shareHeaders } from "./address";
import { problemOf } from "./problem";
import type { paths } from "./schema";

export const ROOT = "/api/v1";

/** The server's paths below the root of the API. */
type Paths = {
  [Path in keyof paths as Path extends `${typeof ROOT}${infer Below}` ? Below : Path]: paths[Path];
};

export const client = createClient<Paths>({ baseUrl: ROOT, headers: shareHeaders });

export interface Answer<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

export async function success<T>(request: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await request;
  noteStatus(response.status);
  if (!response.ok) throw problemOf(response.status, error);
  return data as T;
}

/** The answer, or null while the server still prepares it. */
export async function whenReady<T>(request: Promise<Answer<unknown>>): Promise<T | null> {
  const value = await success(request);
  return (await request).response.status === 202 ? null : (value as T);
}

export const SIGNED_OUT = "microcosmos:signed-out";

let signedOut = false;

export const isSignedOut = () => signedOut;

export function noteStatus(status: number): void {
  if (status !== 401 || signedOut) return;
  signedOut = true;
  globalThis.dispatchEvent?.(new Event(SIGNED_OUT));
}
