/** A region drawn over an element with the mouse or a pen; fingers scroll instead. */

import { useEffect, useRef, useState } from "preact/hooks";
import { type Region, regionOf } from "./selection";
import type { Position } from "./layout";

/** The shortest drag, in pixels; shorter movements are clicks. */
const MIN_DISTANCE = 5;

/** `onEnd` gets the region when the button is released. */
export function useLasso(enabled: boolean, onEnd: (region: Region, event: PointerEvent) => void) {
  const started = useRef<{ event: PointerEvent; way: Position[] } | null>(null);
  const [region, setRegion] = useState<Region | null>(null);
  const dragged = useRef(false);
  const stop = () => {
    started.current = null;
    setRegion(null);
  };
  useEffect(() => {
    if (!region) return;
    const press = (event: KeyboardEvent) => event.key === "Escape" && stop();
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, [region !== null]);
  return {
    region,
    /** True if a click is the end of a drag. */
    wasDrag: () => dragged.current,
    /** True while a region is drawn. */
    onMove: (event: PointerEvent): boolean => {
      if (started.current && (event.buttons & 1) === 0) stop(); // Released outside.
      if (!started.current) return false;
      const { event: first, way } = started.current;
      const far = Math.hypot(event.clientX - first.clientX, event.clientY - first.clientY);
      if (!dragged.current && far < MIN_DISTANCE) return false;
      if (!dragged.current) (event.currentTarget as Element).setPointerCapture(event.pointerId);
      dragged.current = true;
      way.push(positionOf(event));
      setRegion(regionOf(way));
      return true;
    },
    handlers: {
      onPointerDown: (event: PointerEvent) => {
        dragged.current = false;
        if (!enabled || event.button !== 0 || event.pointerType === "touch") return;
        started.current = { event, way: [positionOf(event)] };
      },
      onPointerUp: (event: PointerEvent) => {
        if (started.current && dragged.current) {
          onEnd(regionOf([...started.current.way, positionOf(event)]), event);
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
