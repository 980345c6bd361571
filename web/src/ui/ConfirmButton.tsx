/** A button for an action that cannot be undone: it asks for confirmation in place. */

import { useDisclosure } from "./disclosure";
import { text } from "./text";

interface Props {
  /** The action and its object. */
  verb: string;
  what: string;
  onConfirm: () => Promise<void>;
}

export function ConfirmButton({ verb, what, onConfirm: onDo }: Props) {
  const { open, setOpen, button, first } = useDisclosure<HTMLButtonElement>();
  const keep = () => setOpen(false);
  if (!open) {
    return (
      <button ref={button} class="slim danger" aria-label={`${verb} ${what}`} onClick={() => setOpen(true)}>
        {verb}
      </button>
    );
  }
  return (
    <span class="actions" onKeyDown={(event) => event.key === "Escape" && keep()}>
      <button
        ref={first}
        class="slim danger"
        aria-label={text.confirm(verb, what)}
        onClick={() => void onDo().finally(keep)}
      >
        {text.confirmShort(verb)}
      </button>
      <button class="slim plain" onClick={keep}>
        {text.keep}
      </button>
    </span>
  );
}
