/** Components that are loaded when they are first shown. */

import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";
import { text } from "./text";

/** Show a `section` (or `main`) until the component is loaded. */
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
    return (
      <Around class="lazy">{failed ? <LoadFailed /> : <p class="quiet loading">{text.loading}</p>}</Around>
    );
  };
}

/** The server was updated since this tab was opened, or cannot be reached. */
function LoadFailed() {
  return (
    <p class="banner wrong" role="alert">
      {text.notLoaded} <button onClick={() => location.reload()}>{text.reload}</button>
    </p>
  );
}
