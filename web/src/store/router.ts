/** Routes, navigation, and the view in the query of the address. */

import { useEffect, useState } from "preact/hooks";

export type Route =
  | { page: "runs" }
  | { page: "new" }
  | { page: "compare" }
  | { page: "workers" }
  | { page: "shares" }
  | { page: "commons" }
  | { page: "share"; slug: string; sha: string | null }
  | { page: "settings" }
  | { page: "run"; id: string }
  | { page: "sweep"; id: string }
  | { page: "creature"; sha: string }
  | { page: "unknown" };

export interface PageLocation {
  route: Route;
  query: URLSearchParams;
}

const PAGES = ["new", "compare", "workers", "shares", "commons", "settings"] as const;
const isPage = (name: string): name is (typeof PAGES)[number] => (PAGES as readonly string[]).includes(name);

export function routeOf(path: string): Route {
  const [first, second, ...rest] = path.split("/").filter(Boolean);
  if (first === undefined) return { page: "runs" };
  if (second === undefined && isPage(first)) return { page: first };
  const name = rest.length === 0 ? decodePart(second) : null;
  if (name !== null && first === "runs") return { page: "run", id: name };
  if (name !== null && first === "sweeps") return { page: "sweep", id: name };
  if (name !== null && first === "creatures") return { page: "creature", sha: name };
  if (first === "s" && second !== undefined) return sharedRoute(second, rest);
  return { page: "unknown" };
}

/** A share, or a creature in it. */
function sharedRoute(slug: string, [kind, sha, ...more]: string[]): Route {
  if (kind === undefined) return { page: "share", slug, sha: null };
  const one = kind === "creatures" && sha !== undefined && more.length === 0;
  return one ? { page: "share", slug, sha } : { page: "unknown" };
}

const UUID = /^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$/i;

export const isUuid = (id: string) => UUID.test(id);

/** False for text that can name no run, sweep or creature. */
export const isId = (id: string) => isUuid(id) || /^[0-9a-f]{64}$/.test(id);

/** Null for a missing part or malformed escapes. */
function decodePart(part: string | undefined): string | null {
  try {
    return part === undefined ? null : decodeURIComponent(part);
  } catch {
    return null;
  }
}

const NAVIGATED = "microcosmos:moved";

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
  useEffect(() => {
    const update = () => setAddress(location.pathname + location.search);
    window.addEventListener("popstate", update);
    window.addEventListener(NAVIGATED, update);
    document.addEventListener("click", followLink);
    return () => {
      window.removeEventListener("popstate", update);
      window.removeEventListener(NAVIGATED, update);
      document.removeEventListener("click", followLink);
    };
  }, []);
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
  if (link.hash) return;
  event.preventDefault();
  navigate(link.pathname + link.search);
}
