/** A button that opens other controls in its place; the focus follows. */

import { useEffect, useRef, useState } from "preact/hooks";

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
