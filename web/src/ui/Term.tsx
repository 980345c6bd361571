/** A title that shows the definition of its term when it is pointed at or has the focus. */

import type { ComponentChildren } from "preact";
import { useId, useState } from "preact/hooks";
import { define } from "./glossary";
import { px } from "./px";

/** Pixels that a definition is wide at most. */
const WIDTH = 320;

interface Props {
  name: string;
  /** A button with this title, which has the focus itself. */
  children?: ComponentChildren;
}

/** Show a popover above everything: no ancestor moves or clips it. */
const showAbove = (popover: HTMLElement | null) => popover?.showPopover();

/** Additions, plurals and units are ignored: “Evaluations/s” is explained as “evaluation”. */
export function Term({ name, children }: Props) {
  const about = define(name) ?? define(name.replace(/ (of|\().*$/, "").replace(/s?(\/s)?$/, ""));
  const [place, setPlace] = useState<{ left: number; top: number } | null>(null);
  const id = useId();
  if (!about) return <>{children ?? name}</>;
  const show = ({ currentTarget }: { currentTarget: HTMLElement }) => {
    const { left, bottom } = currentTarget.getBoundingClientRect();
    setPlace({ left: Math.max(8, Math.min(left, window.innerWidth - WIDTH - 8)), top: bottom + 4 });
  };
  const hide = () => setPlace(null);
  return (
    <span
      class="term"
      tabIndex={children ? undefined : 0}
      aria-describedby={place ? id : undefined}
      onPointerEnter={show}
      onPointerLeave={hide}
      onFocusIn={show}
      onFocusOut={hide}
      onKeyDown={(event) => event.key === "Escape" && hide()}
    >
      {children ?? name}
      {place && (
        <span id={id} ref={showAbove} role="tooltip" popover="manual" class="tooltip" style={px(place)}>
          {about}
        </span>
      )}
    </span>
  );
}
