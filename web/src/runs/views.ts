/** Named views of the list of runs, kept in the browser: filters, order, columns and groups. */

import { useState } from "preact/hooks";

export interface View {
  name: string;
  /** The query of the address. */
  query: string;
}

const STORAGE_KEY = "microcosmos:views";
export const MAX_NAME = 60;

/** What a browser has kept; nothing if that cannot be read. */
export function parseViews(kept: string | null): View[] {
  try {
    const found: unknown = JSON.parse(kept ?? "[]");
    return Array.isArray(found) ? found.filter(isView) : [];
  } catch {
    return [];
  }
}

function isView(value: unknown): value is View {
  const { name, query } = (value ?? {}) as Partial<View>;
  return typeof name === "string" && typeof query === "string";
}

/** The views with another one, which replaces one of the same name. */
export const withView = (views: readonly View[], view: View): View[] =>
  [...views.filter(({ name }) => name !== view.name), view].sort((a, b) => a.name.localeCompare(b.name));

export function useViews() {
  const [views, setViews] = useState(() => parseViews(localStorage.getItem(STORAGE_KEY)));
  const keep = (next: View[]) => {
    localStorage.setItem(STORAGE_KEY, JSON.stringify(next));
    setViews(next);
  };
  return {
    views,
    save: (view: View) => keep(withView(views, view)),
    remove: (name: string) => keep(views.filter((view) => view.name !== name)),
  };
}
