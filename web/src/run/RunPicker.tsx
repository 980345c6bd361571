/** A button that opens a choice of another run, and the short form in place of such a button. */

import { useEffect, useRef } from "preact/hooks";
import type { Run } from "../api/types";
import { useExperiments, useRunChoices } from "../store/fetch";
import { dateTime, shortId, titleOf } from "../ui/format";
import { useDisclosure, composes } from "../ui/forms";
import { text } from "./text";
import type { ComponentChildren, RefObject } from "preact";

interface Props {
  run: Run;
  label: string;
  fits: (other: Run) => boolean;
  onSelect: (id: string) => void;
}

export function RunPicker(props: Props) {
  const { open, setOpen, button } = useDisclosure();
  if (open) return <RunSelect {...props} onClose={() => setOpen(false)} />;
  return (
    <button ref={button} class="slim" onClick={() => setOpen(true)}>
      {props.label}
    </button>
  );
}

function RunSelect({ run, label, fits, onSelect, onClose }: Props & { onClose: () => void }) {
  const { value, error } = useRunChoices(run.id);
  const experiments = useExperiments().value ?? [];
  const select = useRef<HTMLSelectElement>(null);
  const close = useRef<HTMLButtonElement>(null);
  const fitting = value?.filter(fits) ?? [];
  const none = error ?? (value && fitting.length === 0 ? text.noOtherRun : null);
  useEffect(() => (select.current ?? close.current)?.focus(), [none, value === null]);
  const choose = () => {
    const id = select.current?.value;
    if (!id) return select.current?.focus();
    onClose();
    onSelect(id);
  };
  return (
    <InlineForm onSubmit={choose} onClose={onClose} closeButton={close}>
      {none ? (
        <span class={error ? "wrong-text" : "quiet"} role="status">
          {none}
        </span>
      ) : (
        <>
          <select ref={select} aria-label={label} aria-busy={!value}>
            <option value="">{value ? text.selectRun : text.loadingRuns}</option>
            {fitting.map((other) => (
              <option key={other.id} value={other.id}>
                {titleOf(other, experiments)} {shortId(other.id)}, {dateTime(other.created_at)}
              </option>
            ))}
          </select>
          <button class="slim" disabled={!value}>
            {text.compare}
          </button>
        </>
      )}
    </InlineForm>
  );
}

interface InlineFormProps {
  onSubmit: () => void;
  onClose: () => void;
  closeButton?: RefObject<HTMLButtonElement | null>;
  children: ComponentChildren;
}

export function InlineForm({ onSubmit, onClose, closeButton, children }: InlineFormProps) {
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
