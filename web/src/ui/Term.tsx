/** A title that shows the definition of its term in docs/glossary.md, or the meaning of its measure. */

import type { ComponentChildren } from "preact";
import { useId, useState } from "preact/hooks";
import { px } from "./canvas";
import { aboutOf } from "./measures";

const MAX_WIDTH_PX = 320;

interface Props {
  name: string;
  /** A button with this title, which has the focus itself. */
  children?: ComponentChildren;
}

/** Show a popover above everything: no ancestor moves or clips it. */
const showAbove = (popover: HTMLElement | null) => popover?.showPopover();

/** Additions, plurals and units are ignored: “Evaluations/s” is explained as “evaluation”. */
export function Term({ name, children }: Props) {
  const plain = name.replace(/ (of|so far|\().*$/, "").replace(/s?(\/s)?$/, "");
  const about = define(name) ?? aboutOf(name) ?? define(plain);
  const [place, setPlace] = useState<{ left: number; top: number } | null>(null);
  const id = useId();
  if (!about) return <>{children ?? name}</>;
  const show = ({ currentTarget }: { currentTarget: HTMLElement }) => {
    const { left, bottom } = currentTarget.getBoundingClientRect();
    setPlace({ left: Math.max(8, Math.min(left, window.innerWidth - MAX_WIDTH_PX - 8)), top: bottom + 4 });
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

import text from "../../../docs/glossary.md?raw";

/** Each `## term` with its paragraph, as plain text. */
export function parse(markdown: string): Map<string, string> {
  const entries = markdown.split(/^## /m).slice(1);
  return new Map(
    entries.map((entry) => {
      const [term, ...lines] = entry.trim().split("\n");
      const plain = lines.join(" ").replace(/`|\[([^\]]*)\]\([^)]*\)/g, "$1");
      return [term!.toLowerCase(), plain.trim()];
    }),
  );
}

const GLOSSARY = parse(text);

export const define = (term: string): string | undefined => GLOSSARY.get(term.toLowerCase());
