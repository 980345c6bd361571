/** Where a page is at home: in the whole installation, or in one share, beyond which it asks nothing. */

const ROOT = "/api/v1";
const path = globalThis.location?.pathname ?? "";

/** Whether strangers may see the page at an address. */
export const isPublicPage = (path: string) => /^\/(s\/.|commons\/?$)/.test(path);

/** The share that this page shows; null where it is a page of the installation itself. */
export const sharedSlug = /^\/s\/([\w-]+)/.exec(path)?.[1] ?? null;

/** What every address of a file begins with. */
export const API_BASE = sharedSlug ? `${ROOT}/shares/${sharedSlug}` : ROOT;

/** The address of a request, moved below the share. */
export function belowShare(url: string): string {
  const asked = new URL(url);
  if (sharedSlug && !asked.pathname.startsWith(`${ROOT}/shares/`)) {
    asked.pathname = asked.pathname.replace(ROOT, API_BASE);
  }
  return asked.href;
}

/** The path of a page, moved below the share. */
export const pageUrl = (path: string) => (sharedSlug ? `/s/${sharedSlug}${path}` : path);
