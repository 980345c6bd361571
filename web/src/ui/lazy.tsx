/** Pages, and parts of them, whose script comes when they are first opened. */

import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";

/** A part of a page is a `section` until it is there. */
export function lazy<P extends object>(
  load: () => Promise<ComponentType<P>>,
  Around: "main" | "section" = "main",
): ComponentType<P> {
  let Found: ComponentType<P> | null = null;
  return function Later(props: P) {
    const [, redraw] = useState(0);
    const [failed, setFailed] = useState(false);
    useEffect(() => {
      if (Found) return;
      load().then(
        (found) => {
          Found = found;
          redraw((count) => count + 1);
        },
        () => setFailed(true),
      );
    }, []);
    if (Found) return <Found {...props} />;
    return <Around>{failed ? <LoadFailed /> : <p class="quiet loading">Loading …</p>}</Around>;
  };
}

/** The server was updated since this tab was opened, or cannot be reached. */
function LoadFailed() {
  return (
    <p class="banner wrong" role="alert">
      This part of the page could not be loaded. <button onClick={() => location.reload()}>Reload</button>
    </p>
  );
}
