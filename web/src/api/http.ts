/** The HTTP client: it sends the share of the page and throws problems. */

import createClient from "openapi-fetch";
import { shareHeaders } from "./address";
import { problemOf } from "./problem";
import type { paths } from "./schema";
import { noteStatus } from "./signedOut";

export const ROOT = "/api/v1";

export const client = createClient<paths>({ baseUrl: "", headers: shareHeaders });

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
