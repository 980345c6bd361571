/** The HTTP client, which names the share of the page and throws problems. */

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

export async function success<T>(asked: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await asked;
  noteStatus(response.status);
  if (!response.ok) throw problemOf(response.status, error);
  return data as T;
}

/** The answer, or null while the server still prepares it. */
export async function whenReady<T>(asked: Promise<Answer<unknown>>): Promise<T | null> {
  const value = await success(asked);
  return (await asked).response.status === 202 ? null : (value as T);
}
