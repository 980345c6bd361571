/** A box drawn over an element with the mouse or a pen; fingers scroll instead. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Box } from "./selection";
import type { Position } from "./layout";

/** The shortest drag, in pixels; shorter movements are clicks. */
const MIN_DISTANCE = 5;

/** `onEnd` gets the box when the button is released. */
export function useBoxSelect(enabled: boolean, onEnd: (box: Box, event: PointerEvent) => void) {
  const started = useRef<{ event: PointerEvent; from: Position } | null>(null);
  const [box, setBox] = useState<Box | null>(null);
  const dragged = useRef(false);
  const stop = () => {
    started.current = null;
    setBox(null);
  };
  useEffect(() => {
    if (!box) return;
    const press = (event: KeyboardEvent) => event.key === "Escape" && stop();
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, [box !== null]);
  return {
    box,
    /** True if a click is the end of a drag. */
    wasDrag: () => dragged.current,
    /** True while a box is drawn. */
    onMove: (event: PointerEvent): boolean => {
      if (!started.current) return false;
      const { event: first, from } = started.current;
      const far = Math.hypot(event.clientX - first.clientX, event.clientY - first.clientY);
      if (!dragged.current && far < MIN_DISTANCE) return false;
      if (!dragged.current) (event.currentTarget as Element).setPointerCapture(event.pointerId);
      dragged.current = true;
      setBox({ from, to: positionOf(event) });
      return true;
    },
    handlers: {
      onPointerDown: (event: PointerEvent) => {
        dragged.current = false;
        if (!enabled || event.button !== 0 || event.pointerType === "touch") return;
        started.current = { event, from: positionOf(event) };
      },
      onPointerUp: (event: PointerEvent) => {
        if (started.current && dragged.current) {
          onEnd({ from: started.current.from, to: positionOf(event) }, event);
        }
        stop();
      },
      onPointerCancel: stop,
    },
  };
}

/** The position on the element, clipped to [0, 1). */
function positionOf(event: PointerEvent): Position {
  const { left, top, width, height } = (event.currentTarget as Element).getBoundingClientRect();
  const bounded = (share: number) => Math.min(1 - 1e-9, Math.max(0, share));
  return [bounded((event.clientX - left) / width), bounded((event.clientY - top) / height)];
}
