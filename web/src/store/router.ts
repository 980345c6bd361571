/** Routes, navigation, and the view in the query of the address. */

import { useState } from "preact/hooks";
import { useListener } from "./polling";

/** A page, with the run, sweep or creature that it shows, or the share and a creature in it. */
interface Route {
  page: string;
  id?: string;
  slug?: string;
  sha?: string;
}

export interface PageLocation {
  route: Route;
  query: URLSearchParams;
}

const PAGES = ["new", "compare", "workers", "shares", "commons", "settings", "import"];
const PAGES_OF_ONE: Record<string, string> = { runs: "run", sweeps: "sweep", creatures: "creature" };
/** Trees of one: below their pages. */
const TREES: Record<string, string> = { runs: "run-tree", creatures: "creature-tree" };

export function routeOf(path: string): Route {
  const [first, second, ...rest] = path.split("/").filter(Boolean);
  if (first === undefined) return { page: "runs" };
  if (second === undefined) return { page: PAGES.includes(first) ? first : "unknown" };
  if (first === "s") return sharedRoute(second, rest);
  const page = rest.length === 0 ? PAGES_OF_ONE[first] : rest.join() === "tree" ? TREES[first] : undefined;
  const id = decodePart(second);
  return page && id !== null ? { page, id } : { page: "unknown" };
}

function sharedRoute(slug: string, [kind, sha, ...more]: string[]): Route {
  if (kind === undefined) return { page: "share", slug };
  if (kind === "embed" && sha === undefined) return { page: "embed", slug };
  if (kind === "tree" && sha === undefined) return { page: "share-tree", slug };
  if (kind === "creatures" && sha !== undefined && more.join() === "tree") {
    return { page: "share-tree", slug, sha };
  }
  const isCreature = kind === "creatures" && sha !== undefined && more.length === 0;
  return isCreature ? { page: "share", slug, sha } : { page: "unknown" };
}

const UUID = /^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$/i;

export const isUuid = (id: string) => UUID.test(id);

/** False for text that can name no run, sweep or creature. */
export const isId = (id: string) => isUuid(id) || /^[0-9a-f]{64}$/.test(id);

/** Null for malformed escapes. */
function decodePart(part: string): string | null {
  try {
    return decodeURIComponent(part);
  } catch {
    return null;
  }
}

const NAVIGATED = "microcosmos:navigated";

export function navigate(to: string, replace = false): void {
  history[replace ? "replaceState" : "pushState"](null, "", to);
  if (!replace) window.scrollTo(0, 0);
  window.dispatchEvent(new Event(NAVIGATED));
}

/** Change parameters of the address; null removes one. */
export function setQuery(changes: Record<string, string | null>): void {
  const query = new URLSearchParams(location.search);
  for (const [key, value] of Object.entries(changes)) {
    if (value === null) query.delete(key);
    else query.set(key, value);
  }
  const text = query.toString();
  navigate(location.pathname + (text ? `?${text}` : ""), true);
}

export function useLocation(): PageLocation {
  const [address, setAddress] = useState(location.pathname + location.search);
  const update = () => setAddress(location.pathname + location.search);
  useListener("popstate", update);
  useListener(NAVIGATED, update);
  useListener("click", followLink);
  const { pathname, searchParams } = new URL(address, location.origin);
  return { route: routeOf(pathname), query: searchParams };
}

/** Clicks on links within the application do not reload the page. */
function followLink(event: MouseEvent): void {
  if (event.defaultPrevented || event.button !== 0) return;
  if (event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
  const link = (event.target as Element).closest?.("a");
  if (!link || link.target || link.hasAttribute("download")) return;
  if (link.origin !== location.origin || link.pathname.startsWith("/api/")) return;
  if (link.hash && link.pathname === location.pathname) return;
  event.preventDefault();
  navigate(link.pathname + link.search + link.hash);
}
