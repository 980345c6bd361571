/** HTML that shows a share within another page. */

import type { Share } from "../api/types";

const [WIDTH, HEIGHT] = [480, 560];

/** `sha` is a creature of a shared archive; without one its best is shown. */
export function embedCode({ url, title, run }: Share, sha: string | null): string {
  const address = `${url}/embed${run && sha ? `?creature=${sha}` : ""}`;
  return `<iframe src="${address}" title="${quoted(title)}" width="${WIDTH}" height="${HEIGHT}" style="border: 0; max-width: 100%" loading="lazy"></iframe>`;
}

const quoted = (words: string) =>
  words.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");
