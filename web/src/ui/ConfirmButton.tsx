/** A button for what cannot be taken back: it asks once more, in its own place. */

import { useDisclosure } from "./disclosure";

interface Props {
  /** What it does, and to what. */
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
        aria-label={`${verb} now: ${what}`}
        onClick={() => void onDo().finally(keep)}
      >
        {verb} now
      </button>
      <button class="slim plain" onClick={keep}>
        Keep
      </button>
    </span>
  );
}
