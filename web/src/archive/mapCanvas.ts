/** The canvas of a map. */

import type { RefObject } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { Elites } from "../store/elites";
import { useSize, prefersReducedMotion, useTheme } from "../ui/canvas";
import { type Picture, FLASH_MS, MapPainter } from "./drawMap";

type MapContent = Pick<Picture, "layout" | "tiles" | "colouring" | "selected">;

/** Draw the map when it changes, and flash changed cells. */
export function useMapCanvas(plot: RefObject<HTMLElement | null>, drawn: MapContent, elites: Elites) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const painter = useMemo(() => new MapPainter(), []);
  const size = useSize(plot);
  const theme = useTheme();
  const changed = useChanges(elites);
  useEffect(() => {
    const element = canvas.current;
    if (!element || size.width === 0) return;
    const picture = { ...drawn, theme, changed };
    const stop = animate((now) => {
      painter.draw(element, size, picture, now);
      return [...changed.values()].some((time) => now - time < FLASH_MS);
    });
    performance.clearMarks("map");
    performance.mark("map");
    return stop;
  }, [size, theme, changed, ...Object.values(drawn)]);
  return canvas;
}

/** The time of the last change of each cell; the first elites do not count. */
function useChanges(elites: Elites): ReadonlyMap<number, number> {
  const seen = useRef<Elites | null>(null);
  const times = useRef<ReadonlyMap<number, number>>(new Map());
  if (seen.current !== elites) {
    const before = seen.current;
    const now = performance.now();
    const next = new Map([...times.current].filter(([, time]) => now - time < FLASH_MS));
    for (const [cell, elite] of before && !prefersReducedMotion() ? elites : []) {
      if (before!.get(cell)?.creature !== elite.creature) next.set(cell, now);
    }
    seen.current = elites;
    times.current = next;
  }
  return times.current;
}

/** Draw at once, and in every frame while `draw` returns true. */
function animate(draw: (now: number) => boolean): () => void {
  let frame = 0;
  const step = () => {
    if (draw(performance.now())) frame = requestAnimationFrame(step);
  };
  step();
  return () => cancelAnimationFrame(frame);
}
