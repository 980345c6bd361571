/** Two choices that need each other: a body that grows from a plan, and the encoding with plans. */

import type { Json } from "../../api/types";
import { valueAt, withValue } from "./document";
import { type Section, type Union } from "./fields";
import { text } from "./text";

const GROWN = { body: ["builder", "grown"], control: ["encoding", "body-graph"] } as const;

type Part = keyof typeof GROWN;

const PARTNER: Record<Part, Part> = { body: "control", control: "body" };

/** The reason why the form has changed the choice of a part. */
export interface Note {
  path: Part;
  /** The selected name. */
  name: string;
  message: string;
}

const nameAt = (document: Json, part: Part) => valueAt(document, `${part}.${GROWN[part][0]}`);

const isGrown = (document: Json, part: Part) => nameAt(document, part) === GROWN[part][1];

/**
 * The document after a change, with the partner of a changed choice: that of the original if it fits,
 * otherwise one with its defaults.
 */
export function withPartner(
  form: Section,
  original: Json,
  before: Json,
  after: Json,
): { document: Json; note: Note | null } {
  const unchanged = { document: after, note: null };
  const changed = (Object.keys(GROWN) as Part[]).find(
    (part) => isGrown(before, part) !== isGrown(after, part),
  );
  if (!changed) return unchanged;
  const path = PARTNER[changed];
  const needed = isGrown(after, changed);
  const union = form.fields.find((field): field is Union => field.path === path && field.kind === "union");
  if (!union || isGrown(after, path) === needed) return unchanged;
  const name = needed ? GROWN[path][1] : [...union.parts.keys()].find((one) => one !== GROWN[path][1])!;
  const initial = union.parts.get(name)?.initial;
  const value = isGrown(original, path) === needed ? valueAt(original, path) : initial;
  if (value === undefined) return unchanged;
  const document = withValue(after, path, value);
  const [selected, cause] = [String(nameAt(document, path)), String(nameAt(after, changed))];
  const message = text.partner(GROWN[path][0], selected, cause);
  return { document, note: { path, name: selected, message } };
}

/** The message of a note, as long as its choice stays selected. */
export function messageOf(note: Note | null, document: Json, path: string): string | null {
  return note?.path === path && nameAt(document, note.path) === note.name ? note.message : null;
}
