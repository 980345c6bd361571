/** Components that are loaded when they are first shown. */

import type { ComponentType, FunctionComponent } from "preact";
import { useEffect, useState } from "preact/hooks";
import { text } from "./text";

/** Show a `section` (or `main`, or nothing) until the component is loaded. */
export function lazy<P extends object>(
  load: () => Promise<ComponentType<P>>,
  Placeholder: "main" | "section" | null = "main",
): FunctionComponent<P> {
  let Loaded: ComponentType<P> | null = null;
  return function LazyComponent(props: P) {
    const [, redraw] = useState(0);
    const [failed, setFailed] = useState(false);
    useEffect(() => {
      if (Loaded) return;
      load().then(
        (component) => {
          Loaded = component;
          redraw((count) => count + 1);
        },
        () => setFailed(true),
      );
    }, []);
    if (Loaded) return <Loaded {...props} />;
    if (!Placeholder) return failed ? <LoadFailed /> : null;
    return (
      <Placeholder class="lazy">
        {failed ? <LoadFailed /> : <p class="quiet loading">{text.loading}</p>}
      </Placeholder>
    );
  };
}

/** Shown if the server was updated after the tab was opened, or cannot be reached. */
function LoadFailed() {
  return (
    <p class="banner wrong" role="alert">
      {text.notLoaded} <button onClick={() => location.reload()}>{text.reload}</button>
    </p>
  );
}
