/** A mark on everything whose coupling is not force-free. */

import { NOT_FREE } from "./coupling";

export function NotForceFree({ some = false }: { some?: boolean }) {
  return (
    <span class="badge not-force-free" title={NOT_FREE}>
      {some ? "partly not force-free" : "not force-free"}
    </span>
  );
}
