/** The mark of elites that their audit does not trust, on the map and in the gallery. */

import type { Theme } from "../ui/canvas";

const INKS = { light: ["#ffffff", "#12222c"], dark: ["#111b21", "#fdf8ec"] } as const;

/** Draw a small cross on a light or dark ground, with a border; lengths in pixels. */
export function markDistrusted(
  context: CanvasRenderingContext2D,
  [x, y]: readonly [number, number],
  radius: number,
  ground: Theme,
): void {
  const [border, ink] = INKS[ground];
  context.beginPath();
  for (const slope of [1, -1]) {
    context.moveTo(x - radius, y - slope * radius);
    context.lineTo(x + radius, y + slope * radius);
  }
  for (const [style, width] of [
    [border, 3.5],
    [ink, 1.5],
  ] as const) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }
}
