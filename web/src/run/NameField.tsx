/** A name that is edited in place. */

import type { ComponentChildren } from "preact";
import { useDisclosure } from "../ui/disclosure";
import { InlineText } from "../ui/InlineText";
import { text } from "./text";

interface NameProps {
  of: { name: string | null };
  title: string;
  /** True if the name cannot be changed. */
  fixed: boolean;
  onName: (name: string | null) => void;
  children: ComponentChildren;
}

/** A name, and a button that makes it a field. */
export function NameField({ of, title, fixed, onName, children }: NameProps) {
  const { open, setOpen, button } = useDisclosure();
  const done = (name: string | null) => {
    setOpen(false);
    if (name !== null && name !== (of.name ?? "") && name !== title) onName(name || null);
  };
  if (fixed) return <>{children}</>;
  if (open) return <InlineText label={text.nameOf(title)} value={title} limit={200} onDone={done} />;
  return (
    <>
      {children}
      <button
        ref={button}
        class="plain small-button"
        aria-label={text.renameRun(title)}
        title={text.rename}
        onClick={() => setOpen(true)}
      >
        ✎
      </button>
    </>
  );
}
