/** A name that is edited in place. */

import type { ComponentChildren } from "preact";
import { useDisclosure } from "../ui/forms";
import { InlineText } from "../ui/InlineText";
import { text } from "./text";

interface NameProps {
  of: { name: string | null };
  title: string;
  readOnly: boolean;
  onName: (name: string | null) => void;
  children: ComponentChildren;
}

export function NameField({ of, title, readOnly, onName, children }: NameProps) {
  const { open, setOpen, button } = useDisclosure();
  const done = (name: string | null) => {
    setOpen(false);
    if (name !== null && name !== (of.name ?? "") && name !== title) onName(name || null);
  };
  if (readOnly) return <>{children}</>;
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
