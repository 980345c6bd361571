/** Where a page is at home: in the whole installation, or in one share, beyond which it asks nothing. */

const path = globalThis.location?.pathname ?? "";

/** Whether strangers may see the page at an address. */
export const isPublicPage = (path: string) => /^\/(s\/.|commons\/?$)/.test(path);

/** The share that this page shows; null where it is a page of the installation itself. */
export const sharedSlug = /^\/s\/([\w-]+)/.exec(path)?.[1] ?? null;

/** What names a share in requests: its holder reads on the ordinary routes what it shows. */
export const SHARE_HEADER = "Microcosmos-Share";
export const shareHeaders: Record<string, string> = sharedSlug ? { [SHARE_HEADER]: sharedSlug } : {};

/** The path of a page, moved below the share. */
export const pageUrl = (path: string) => (sharedSlug ? `/s/${sharedSlug}${path}` : path);
