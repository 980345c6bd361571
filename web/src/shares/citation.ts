/** Citations of shares: one line, and an entry for BibTeX. */

import type { Share } from "../api/types";
import { text } from "./text";

/** A creature is cited with its SHA-256, which names it everywhere. */
export type Cited = Pick<Share, "title" | "credit" | "url" | "created_at" | "generation"> & {
  sha: string | null;
};

const yearOf = ({ created_at }: Cited) => created_at.slice(0, 4);
const namesOf = ({ credit }: Cited) => (credit.length > 0 ? credit : [text.anonymous]);
const kindOf = ({ sha, generation }: Cited) =>
  sha ? text.citedCreature(sha) : text.citedArchive(generation);

export const citation = (share: Cited) =>
  `${namesOf(share).join(", ")} (${yearOf(share)}). ${share.title}. ${kindOf(share)}. ${share.url}`;

/** A name is braced: BibTeX would take it apart. */
export function bibtex(share: Cited): string {
  const names = namesOf(share).map((name) => `{${escaped(name)}}`);
  const fields = {
    author: names.join(" and "),
    title: `{${escaped(share.title)}}`,
    year: yearOf(share),
    howpublished: `\\url{${share.url}}`,
    note: escaped(kindOf(share)),
  };
  const key = `microcosmos-${(share.sha ?? share.url.split("/").pop()!).slice(0, 8)}`;
  const lines = Object.entries(fields).map(([name, value]) => `  ${name} = {${value}},`);
  return [`@misc{${key},`, ...lines, "}"].join("\n");
}

const SPECIAL: Record<string, string> = {
  "\\": "\\textbackslash{}",
  "~": "\\textasciitilde{}",
  "^": "\\textasciicircum{}",
};

const escaped = (words: string) => words.replace(/[\\~^#$%&_{}]/g, (sign) => SPECIAL[sign] ?? `\\${sign}`);
