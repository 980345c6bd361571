/** The state of forms: requests, disclosure of controls, keys of requests. */

import { useState, useEffect, useRef } from "preact/hooks";
import { messageOf } from "../api/problem";

export function useSubmit(send: (form: HTMLFormElement) => Promise<void>) {
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<string | null>(null);
  const submit = async (form: HTMLFormElement) => {
    setBusy(true);
    setError(null);
    await send(form).catch((problem) => setError(messageOf(problem)));
    setBusy(false);
  };
  const onSubmit = (event: Event) => {
    event.preventDefault();
    void submit(event.currentTarget as HTMLFormElement);
  };
  return { busy, error, onSubmit };
}

export function useDisclosure<First extends HTMLElement>() {
  const [open, setOpen] = useState(false);
  const button = useRef<HTMLButtonElement>(null);
  const first = useRef<First>(null);
  const wasOpen = useRef(false);
  useEffect(() => {
    if (open) first.current?.focus();
    else if (wasOpen.current && document.activeElement === document.body) button.current?.focus();
    wasOpen.current = open;
  }, [open]);
  return { open, setOpen, button, first };
}

export function newIdempotencyKey(): string {
  const parts = crypto.getRandomValues(new Uint32Array(4));
  return [...parts].map((part) => part.toString(16).padStart(8, "0")).join("");
}

/** The code of a key that an input method has taken. Safari sends Enter after the conversion has ended. */
const TAKEN = 229;

/** True for a key that an input method takes, as Enter to accept a conversion. */
export const composes = (event: KeyboardEvent) => event.isComposing || event.keyCode === TAKEN;

/** A signal that is aborted when the component is left. */
export function useLeaving(): AbortSignal {
  const leaving = useRef(new AbortController());
  useEffect(() => () => leaving.current.abort(), []);
  return leaving.current.signal;
}

/** Elements that take text or use most keys themselves. */
export const TEXT_FIELDS = "select, textarea, [contenteditable], input:not([type=range], [type=checkbox])";
