/** The scope of the page: the installation, or one share. */

const path = globalThis.location?.pathname ?? "";

export const isPublicPage = (path: string) => /^\/(s\/.|commons\/?$)/.test(path);

/** The share that this page shows; null for a page of the installation. */
export const sharedSlug = /^\/s\/([\w-]+)/.exec(path)?.[1] ?? null;

/** The header that names the share in requests. */
export const SHARE_HEADER = "Microcosmos-Share";
export const shareHeaders: Record<string, string> = sharedSlug ? { [SHARE_HEADER]: sharedSlug } : {};

/** The path of a page, moved below the share. */
export const pageUrl = (path: string) => (sharedSlug ? `/s/${sharedSlug}${path}` : path);
