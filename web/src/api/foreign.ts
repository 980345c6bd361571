/** Shared creatures of other installations: their addresses, and their files, verified by hash. */

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
const ADDRESS =
  /^(https?:\/\/[a-zA-Z0-9.-]+(?::\d+)?(?:\/[\w.~-]+)*)\/s\/([\w-]{1,43})(?:\/creatures\/([0-9a-f]{64}))?\/?$/;

/** The address of the page that imports from a share's address; null for any other text. */
export const importPage = (address: string): string | null =>
  ADDRESS.test(address.trim()) ? `/import?${new URLSearchParams({ share: address.trim() })}` : null;

/** The address of the file at a share's address; null for any other text. */
export function foreignFileUrl(address: string): string | null {
  const [, server, slug, creature] = ADDRESS.exec(address.trim()) ?? [];
  if (!slug) return null;
  return `${server}/api/v1/shares/${slug}/creature.json${creature ? `?creature=${creature}` : ""}`;
}

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
