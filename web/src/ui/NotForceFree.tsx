/** A badge for results whose coupling is not force-free. */

import { text } from "./text";

export function NotForceFree({ some = false }: { some?: boolean }) {
  return (
    <span class="badge not-force-free" title={text.notForceFreeAbout}>
      {some ? text.partlyNotForceFree : text.notForceFree}
    </span>
  );
}
