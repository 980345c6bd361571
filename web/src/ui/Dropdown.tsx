/** A panel with choices that opens below a button, over the page. */

import type { ComponentChildren } from "preact";
import { useRef } from "preact/hooks";
import { useListener } from "../store/polling";

interface Props {
  title: string;
  /** A dot says that something in the panel is not as it was at first. */
  changed?: boolean;
  children: ComponentChildren;
}

export function Dropdown({ title, changed = false, children }: Props) {
  const panel = useRef<HTMLDetailsElement>(null);
  const close = () => panel.current?.removeAttribute("open");
  useListener("pointerdown", ({ target }) => {
    if (!panel.current?.contains(target as Node)) close();
  });
  return (
    <details ref={panel} class="dropdown" onKeyDown={(event) => event.key === "Escape" && close()}>
      <summary class={changed ? "changed" : ""}>{title}</summary>
      <div class="card">{children}</div>
    </details>
  );
}
