/** Which elites are shown, by the verdicts of their audits. */

import type { Elite, Elites } from "../store/elites";
import { text as words } from "../ui/text";
import { text } from "./text";

const VERDICTS: Record<string, Elite["trusted"]> = { trusted: true, distrusted: false, unaudited: null };

export const TRUST_CHOICES = [
  ["", text.anyVerdict],
  ["trusted", words.trusted],
  ["distrusted", words.notTrusted],
  ["unaudited", words.notAudited],
] as const;

/** The choice in the address; unknown ones are ignored. */
export function trustOf(query: URLSearchParams): string {
  const given = query.get("trust") ?? "";
  return Object.hasOwn(VERDICTS, given) ? given : "";
}

/** The elites with a verdict; all of them without a choice. */
export function withVerdict(elites: Elites, choice: string): Elites {
  const verdict = VERDICTS[choice];
  if (verdict === undefined) return elites;
  return new Map([...elites].filter(([, { trusted }]) => trusted === verdict));
}
