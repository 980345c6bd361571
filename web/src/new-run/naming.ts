/** The name of a new run, made from what differs from its source unless one is typed. */

import { useState } from "preact/hooks";
import type { Json } from "../api/types";
import { number, words } from "../ui/format";
import { leavesOf, valueAt } from "./form/document";
import type { Section } from "./form/fields";

/** Changes that a name tells. */
const MOST = 3;

export function useNaming(source: string, document: Json, form: Section, changed: ReadonlySet<string>) {
  const [typed, type] = useState("");
  const suggested = nameOf(source, document, form, changed);
  return { typed, type, suggested, chosen: typed.trim() || suggested };
}

/** `Demo, viscosity 0.2, nodes 32`; null if nothing differs that a few words can tell. */
export function nameOf(
  source: string,
  document: Json,
  form: Section,
  changed: ReadonlySet<string>,
): string | null {
  const told = leavesOf(form, document).flatMap(({ path, title }) => {
    const value = valueAt(document, path);
    if (!changed.has(path) || value === null || typeof value === "object") return [];
    const shown = typeof value === "number" ? number(value, 4) : String(value).replaceAll("_", " ");
    return [`${title.toLowerCase()} ${shown}`];
  });
  if (told.length === 0) return null;
  return [titleOf(source), ...told.slice(0, MOST)].filter(Boolean).join(", ");
}

/** The title of a preset, with its experiment unless that is the usual one; ids have none. */
function titleOf(source: string): string | null {
  const [experiment, preset] = source.split("/") as [string, string | undefined];
  if (!preset) return null;
  return words(experiment === "quality-diversity" ? preset : `${experiment.replaceAll("-", " ")} ${preset}`);
}
