/** A badge for results whose coupling is not force-free. */

import { NOT_FREE } from "./coupling";
import { text } from "./text";

export function NotForceFree({ some = false }: { some?: boolean }) {
  return (
    <span class="badge not-force-free" title={NOT_FREE}>
      {some ? text.partlyNotForceFree : text.notForceFree}
    </span>
  );
}
