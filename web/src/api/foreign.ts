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
const NAME = /^[0-9a-f]{64}$/;

/** Read a file without telling its server who asks; throw unless each hash is right. */
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
  const { creatures } = (await readForeign(url)).body as { creatures: string[] };
  return creatures.filter((name) => NAME.test(name));
}

/** The file of a creature of a share, from the address of its names; without ancestors. */
export const foreignFileOf = (namesUrl: string, name: string) =>
  `${namesUrl.replace(/creatures\.json$/, "creature.json")}?creature=${name}&ancestors=false`;

async function readForeign(url: string): Promise<{ file: Blob; body: unknown }> {
  const answer = await fetch(url, { credentials: "omit", referrerPolicy: "no-referrer", redirect: "error" });
  const file = await answer.blob();
  if (file.size > MAX_BYTES) throw new Problem(answer.status, { title: text.tooLarge(file.size, MAX_BYTES) });
  const body: unknown = JSON.parse(await file.text());
  if (!answer.ok) throw problemOf(answer.status, body as never);
  return { file, body };
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
