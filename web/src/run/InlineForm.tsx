/** A short form in the place of the button that opened it. */

import type { ComponentChildren, RefObject } from "preact";
import { composes } from "../ui/forms";
import { text } from "./text";

interface Props {
  onSubmit: () => void;
  onClose: () => void;
  closeButton?: RefObject<HTMLButtonElement | null>;
  children: ComponentChildren;
}

export function InlineForm({ onSubmit, onClose, closeButton, children }: Props) {
  return (
    <form
      class="run-choice row small"
      onSubmit={(event) => {
        event.preventDefault();
        onSubmit();
      }}
      onKeyDown={(event) => event.key === "Escape" && !composes(event) && onClose()}
    >
      {children}
      <button ref={closeButton} type="button" class="slim" onClick={onClose}>
        {text.close}
      </button>
    </form>
  );
}
