/** Shared creatures of other installations: their files, verified by hash. */

import { nameOf } from "../decode/identity";
import { Problem, problemOf } from "./problem";
import { text } from "./text";
import type { Creature } from "./types";

export interface ForeignCreature {
  creature: Creature;
  ancestors: Creature[];
  /** The bytes that came. */
  file: Blob;
}

/** The largest file that a server imports. */
const MAX_BYTES = 8 << 20;
/** Read a file without telling its server who asks; throw unless each hash is right. */
export async function readForeignCreature(url: string): Promise<ForeignCreature> {
  const answer = await fetch(url, { credentials: "omit", referrerPolicy: "no-referrer", redirect: "error" });
  const file = await answer.blob();
  if (file.size > MAX_BYTES) throw new Problem(answer.status, { title: text.tooLarge(file.size, MAX_BYTES) });
  const body = JSON.parse(await file.text());
  if (!answer.ok) throw problemOf(answer.status, body);
  const found = verified(body);
  const wanted = new URL(url).searchParams.get("creature");
  if (wanted !== null && found.creature.sha256 !== wanted) {
    throw new Error(text.otherCreature(found.creature.sha256, wanted));
  }
  return { ...found, file: new Blob([file], { type: "application/json" }) };
}

/** The creature of a file and its ancestors; throw unless each hash is right. */
export function verified(body: Creature & { ancestors?: Creature[] }) {
  const { ancestors = [], ...creature } = body;
  for (const { identity, sha256 } of [creature, ...ancestors]) {
    const found = nameOf(identity);
    if (found !== sha256) throw new Error(text.wrongHash(sha256, found));
  }
  return { creature: creature as Creature, ancestors };
}
