/** Addresses of shares, also of other installations. */

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
