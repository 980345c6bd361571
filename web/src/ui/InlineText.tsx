/** A text field for editing in place. */

import { useLayoutEffect, useRef } from "preact/hooks";
import { composes } from "./forms";

interface Props {
  label: string;
  value: string;
  limit: number;
  /** True for several lines: Enter starts a new one. */
  long?: boolean;
  list?: string;
  onDone: (value: string | null) => void;
}

/** Enter or leaving the field accepts the text, Escape discards it. */
export function InlineText({ label, value, limit, long = false, list, onDone }: Props) {
  const field = useRef<HTMLInputElement & HTMLTextAreaElement>(null);
  const ended = useRef(false);
  useLayoutEffect(() => {
    field.current!.focus(); // Before the user types.
    field.current!.select();
  }, []);
  const end = (accept: boolean) => {
    if (ended.current || !field.current) return; // A removed field loses the focus too.
    ended.current = true;
    onDone(accept ? field.current.value.trim() : null);
  };
  const common = {
    ref: field,
    class: "inline-text",
    "aria-label": label,
    maxLength: limit,
    defaultValue: value,
    onBlur: () => end(true),
    onKeyDown: (event: KeyboardEvent) => {
      if (composes(event)) return;
      if (event.key === "Escape") end(false);
      if (event.key === "Enter" && (!long || event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        end(true);
      }
    },
  };
  return long ? <textarea rows={4} {...common} /> : <input type="text" list={list} {...common} />;
}
