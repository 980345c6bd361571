/** Shared creatures of other installations: their files, verified by hash. */

import { parseJson } from "../decode/json";
import { nameOf } from "../decode/identity";
import { Problem, problemOf } from "./problem";
import { text } from "./text";
import type { Creature } from "./types";

export interface ForeignCreature {
  creature: Creature;
  ancestors: Creature[];
  /** The received bytes. */
  file: Blob;
}

/** The largest file that a server imports. */
const MAX_BYTES = 8 << 20;
/** The longest time for the whole file. */
const PATIENCE_MS = 60_000;
const NAME = /^[0-9a-f]{64}$/;

/** Read a file without credentials or referrer; throw unless each hash is right. */
export async function readForeignCreature(url: string): Promise<ForeignCreature> {
  const { file, body } = await readForeign(url);
  const found = verified(body as Creature);
  const wanted = new URL(url).searchParams.get("creature");
  if (wanted !== null && found.creature.sha256 !== wanted) {
    throw new Error(text.otherCreature(found.creature.sha256, wanted));
  }
  return { ...found, file: new Blob([file], { type: "application/json" }) };
}

/** The names of all creatures of a share, the best first. */
export async function readForeignNames(url: string): Promise<string[]> {
  const { creatures } = ((await readForeign(url)).body ?? {}) as { creatures?: unknown };
  if (!Array.isArray(creatures)) throw new Error(text.noShare);
  return (creatures as unknown[]).filter(
    (name): name is string => typeof name === "string" && NAME.test(name),
  );
}

/** The file of a creature of a share, from the address of its names; without ancestors. */
export const foreignFileOf = (namesUrl: string, name: string) =>
  `${namesUrl.replace(/creatures\.json$/, "creature.json")}?creature=${name}&ancestors=false`;

async function readForeign(url: string): Promise<{ file: Blob; body: unknown }> {
  const signal = AbortSignal.timeout(PATIENCE_MS);
  const answer = await fetch(url, {
    credentials: "omit",
    referrerPolicy: "no-referrer",
    redirect: "error",
    signal,
  });
  const file = await limited(answer);
  const body = parsed(await file.text());
  if (!answer.ok) throw problemOf(answer.status, body);
  return { file, body };
}

/** The body of an answer; a larger one than a server imports is not read to its end. */
export async function limited(answer: Response, most = MAX_BYTES): Promise<Blob> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let size = 0;
  for await (const part of chunks(answer)) {
    size += part.length;
    if (size > most) throw new Problem(answer.status, { title: text.tooLarge(most) });
    parts.push(part);
  }
  return new Blob(parts);
}

/** Pieces of a body; it is cancelled where the caller stops. Safari's streams cannot be iterated. */
async function* chunks({ body }: Response) {
  if (!body) return;
  const reader = body.getReader();
  try {
    for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read())
      yield value!;
  } finally {
    await reader.cancel();
  }
}

/** The content of a file; null for text that is not JSON. */
function parsed(text: string): unknown {
  try {
    return parseJson(text);
  } catch {
    return null;
  }
}

/** The creature of a file and its ancestors; throw unless each hash is right. */
export function verified(body: Creature & { ancestors?: Creature[] }) {
  const { ancestors = [], ...creature } = body ?? {};
  const isWhole = Array.isArray(ancestors) && [creature, ...ancestors].every((each) => each?.identity);
  if (!isWhole) throw new Error(text.noShare);
  for (const { identity, sha256 } of [creature, ...ancestors]) {
    const found = nameOf(identity);
    if (found !== sha256) throw new Error(text.wrongHash(sha256, found));
  }
  return { creature: creature as Creature, ancestors };
}
