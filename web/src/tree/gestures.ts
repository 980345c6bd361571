/** Gestures over a tree and its keys: drag, wheel, pinch, arrows; places are in pixels from the upper left corner. */

import type { RefObject } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Place } from "./view";
import { type Phylogeny, NONE } from "../decode/phylogeny";
import { relativeAt } from "./nearest";
import type { Stage } from "./stage";
import type { LoadedTree } from "./TreeView";

/** Movements of fewer pixels are taps. */
const TAP = 5;
const LINE_PIXELS = 16;
/** Natural logarithm of the enlargement by one pixel of the wheel; a pinch on a trackpad has small ones. */
const [WHEEL, TRACKPAD] = [0.0022, 0.012];

interface Gestures {
  pan: (by: Place) => void;
  /** `log` is the natural logarithm of the enlargement. */
  zoom: (log: number, at: Place) => void;
  hover: (at: Place | null) => void;
  tap: (at: Place, byTouch: boolean) => void;
}

export function useGestures(element: RefObject<HTMLElement | null>, gestures: Gestures): void {
  const latest = useRef(gestures);
  latest.current = gestures;
  useEffect(() => listen(element.current!, latest), []);
}

function listen(element: HTMLElement, latest: RefObject<Gestures>): () => void {
  const pointers = new Map<number, Place>();
  let travelled = 0;
  const call = () => latest.current!;
  const placeOf = (event: MouseEvent): Place => {
    const { left, top } = element.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };
  const down = (event: PointerEvent) => {
    if (event.button !== 0) return;
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, placeOf(event));
    element.setPointerCapture(event.pointerId);
  };
  const move = (event: PointerEvent) => {
    const [before, now] = [pointers.get(event.pointerId), placeOf(event)];
    if (!before) {
      if (event.pointerType === "mouse") call().hover(now);
      return;
    }
    travelled += distance(before, now);
    const others = [...pointers.values()].filter((place) => place !== before);
    pointers.set(event.pointerId, now);
    if (others.length === 1) pinch(call(), others[0]!, before, now);
    else if (travelled > TAP) call().pan([now[0] - before[0], now[1] - before[1]]);
  };
  const up = (event: PointerEvent) => {
    const held = pointers.delete(event.pointerId);
    if (!held || event.type !== "pointerup" || pointers.size > 0) return;
    if (travelled <= TAP) call().tap(placeOf(event), event.pointerType !== "mouse");
  };
  const wheel = (event: WheelEvent) => {
    event.preventDefault();
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PIXELS : 1;
    const sideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
    if (sideways) call().pan([-pixels * (event.deltaX || event.deltaY), 0]);
    else call().zoom(-pixels * event.deltaY * (event.ctrlKey ? TRACKPAD : WHEEL), placeOf(event));
  };
  const leave = () => call().hover(null);
  const listeners = { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up, wheel };
  const all = Object.entries({ ...listeners, pointerleave: leave }) as [string, EventListener][];
  for (const [type, listener] of all) element.addEventListener(type, listener, { passive: false });
  return () => {
    for (const [type, listener] of all) element.removeEventListener(type, listener);
  };
}

const distance = (a: Place, b: Place) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** Two fingers: what is between them is enlarged and follows them. */
function pinch({ pan, zoom }: Gestures, other: Place, before: Place, now: Place): void {
  const middle: Place = [(other[0] + now[0]) / 2, (other[1] + now[1]) / 2];
  pan([(now[0] - before[0]) / 2, (now[1] - before[1]) / 2]);
  zoom(Math.log(Math.max(1, distance(other, now)) / Math.max(1, distance(other, before))), middle);
}

/** Enlargement of a step, as its natural logarithm. */
export const ZOOM_STEP = Math.log(1.6);

const ZOOMS: Record<string, number> = { "+": ZOOM_STEP, "=": ZOOM_STEP, "-": -ZOOM_STEP };
/** Pixels by which the window moves. */
const PAN: Record<string, readonly [number, number]> = {
  ArrowLeft: [80, 0],
  ArrowRight: [-80, 0],
  ArrowUp: [0, 80],
  ArrowDown: [0, -80],
};

interface Selection {
  selected: number;
  select: (creature: number) => void;
  open: (creature: number) => void;
}

/** Carry out a key; false if it means nothing here. */
export function press(
  { key, shiftKey }: Pick<KeyboardEvent, "key" | "shiftKey">,
  { tree, layout }: LoadedTree,
  stage: Pick<Stage, "zoom" | "all" | "pan" | "reveal">,
  { selected, select, open }: Selection,
): boolean {
  const zoom = ZOOMS[key];
  const direction = PAN[key];
  if (zoom) stage.zoom(zoom);
  else if (key === "0") stage.all();
  else if (key === "Escape") select(NONE);
  else if (key === "Enter" && selected !== NONE) open(selected);
  else if (direction && shiftKey) stage.pan(direction);
  else if (direction) {
    const next = selected === NONE ? fittest(tree, layout.row) : relativeAt(layout, tree, selected, key);
    if (next === NONE) return false;
    select(next);
    stage.reveal(next);
  } else return false;
  return true;
}

function fittest({ fitness, count }: Phylogeny, row: Int32Array): number {
  let best = NONE;
  for (let i = 0; i < count; i++) {
    if (row[i] !== NONE && (best === NONE || fitness[i]! > fitness[best]!)) best = i;
  }
  return best;
}
