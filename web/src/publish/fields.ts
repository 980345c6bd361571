/** The texts of a share that its publisher gives: in the form, and on the page of the share. */

import type { Share, ShareRequest } from "../api/types";
import { text } from "./text";

type Common = Extract<keyof Share, keyof ShareRequest>;
type TextName = { [Name in Common]: Share[Name] extends string | null ? Name : never }[Common];

interface TextField {
  name: TextName;
  label: string;
  hint: string;
  longest: number;
  heading?: boolean;
}

export const FIELDS: readonly TextField[] = text.fields;

/** The labels and values of the texts that stand under the heading. */
export const factsOf = (share: Share): [label: string, value: string][] =>
  FIELDS.flatMap(({ name, label, heading }): [string, string][] => {
    const value: string | null = share[name];
    return heading || !value ? [] : [[label, value]];
  });
