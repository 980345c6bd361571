/** Initial creatures in specs and forms, and patches between specs. */

import type { Spec } from "../api/types";
import { differences, isObject } from "../run/spec/difference";
import type { Section } from "./form/fields";

/** True if runs of a spec fill an archive and can start from creatures. */
export const isSearch = (spec: Spec): boolean => isObject(spec.search);

/** The spec of a search with these initial creatures. */
export const withInitial = (spec: Spec, names: string[]): Spec => ({
  ...spec,
  search: { ...(spec.search as Spec), initial: names },
});

/** The form without initial creatures, which are selected elsewhere. */
export const withoutInitial = (form: Section): Section => ({
  ...form,
  fields: form.fields
    .filter(({ path }) => path !== "search.initial")
    .map((field) => (field.kind === "section" ? withoutInitial(field) : field)),
});

/** The merge patch (RFC 7396) from one document to another; null removes a member. */
export function mergePatch(from: Spec, to: Spec): Spec {
  const patch: Spec = {};
  for (const key of Object.keys(from)) if (!(key in to)) patch[key] = null;
  for (const [key, value] of Object.entries(to)) {
    const before = from[key];
    if (before !== undefined && differences([{ value: before }, { value }]).length === 0) continue;
    // A part of a patch that is missing in the document is merged into an empty one.
    patch[key] = isObject(value) ? mergePatch(isObject(before) ? before : {}, value) : value;
  }
  return patch;
}
