/** The scope of the page, the installation or one share; and addresses of shares, also of other installations. */

const path = globalThis.location?.pathname ?? "";

export const isPublicPage = (path: string) => /^\/(s\/.|commons\/?$)/.test(path);

/** The share that this page shows; null for a page of the installation. */
export const sharedSlug = /^\/s\/([\w-]+)/.exec(path)?.[1] ?? null;

/** The header that names the share in requests. */
export const SHARE_HEADER = "Microcosmos-Share";
export const shareHeaders: Record<string, string> = sharedSlug ? { [SHARE_HEADER]: sharedSlug } : {};

/** The path of a page, moved below the share. */
export const pageUrl = (path: string) => (sharedSlug ? `/s/${sharedSlug}${path}` : path);

const ADDRESS =
  /^(https?:\/\/[a-zA-Z0-9.-]+(?::\d+)?(?:\/[\w.~-]+)*)\/s\/([\w-]{1,43})(?:\/creatures\/([0-9a-f]{64}))?\/?$/;

/** The address of the page that imports from a share's address; null for any other text. */
export const importPage = (address: string): string | null =>
  ADDRESS.test(address.trim()) ? `/import?${new URLSearchParams({ share: address.trim() })}` : null;

/** The address of the names of all creatures of a share; null for one creature of it, and for any other text. */
export function foreignNamesUrl(address: string): string | null {
  const [, server, slug, creature] = ADDRESS.exec(address.trim()) ?? [];
  return slug && !creature ? `${server}/api/v1/shares/${slug}/creatures.json` : null;
}

/** The address of the file at a share's address; null for any other text. */
export function foreignFileUrl(address: string): string | null {
  const [, server, slug, creature] = ADDRESS.exec(address.trim()) ?? [];
  if (!slug) return null;
  return `${server}/api/v1/shares/${slug}/creature.json${creature ? `?creature=${creature}` : ""}`;
}
