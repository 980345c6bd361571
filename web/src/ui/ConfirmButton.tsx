/** A button for an action that destroys or queues something: it asks for confirmation in place. */

import { useDisclosure } from "./forms";
import { text } from "./text";

interface Props {
  /** The action and its object. */
  verb: string;
  what: string;
  /** A description of the queued work; without it, the action cannot be undone. */
  queues?: string;
  onConfirm: () => Promise<void>;
}

export function ConfirmButton({ verb, what, queues, onConfirm }: Props) {
  const { open, setOpen, button, first } = useDisclosure<HTMLButtonElement>();
  const close = () => setOpen(false);
  const kind = queues ? "" : "slim danger";
  if (!open) {
    return (
      <button ref={button} class={kind} aria-label={`${verb} ${what}`} onClick={() => setOpen(true)}>
        {verb}
      </button>
    );
  }
  return (
    <span class="actions" role="group" onKeyDown={(event) => event.key === "Escape" && close()}>
      {queues && (
        <span class="quiet small confirm" role="status">
          {queues}
        </span>
      )}
      <button
        ref={first}
        class={queues ? "primary" : kind}
        aria-label={text.confirm(verb, what)}
        onClick={() => void onConfirm().finally(close)}
      >
        {text.confirmShort(verb)}
      </button>
      <button class={queues ? "plain" : "slim plain"} onClick={close}>
        {queues ? text.cancel : text.keep}
      </button>
    </span>
  );
}
