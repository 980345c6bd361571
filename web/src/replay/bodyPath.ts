/** Trace a small moving body. */

import type { Motion } from "../decode/replay";
import { chainsOf, meanOf, positionsAt } from "./motion";

/** The colour of a body on a background of each theme. */
export const BODY_INK = { light: "#12222c", dark: "#fdf8ec" };

interface Prepared {
  chains: number[][];
  /** The largest distance of a node from the mean position, in cells. */
  radius: number;
}

const cache = new WeakMap<Motion, Prepared>();

function prepared(motion: Motion): Prepared {
  const known = cache.get(motion);
  if (known) return known;
  const { frames, edges } = motion.header;
  let radius = 0;
  for (let frame = 0; frame < frames; frame++) {
    const points = positionsAt(motion, frame);
    const [x, y] = meanOf(points);
    for (const point of points) radius = Math.max(radius, Math.hypot(point[0] - x, point[1] - y));
  }
  const made = { chains: chainsOf(edges), radius: radius || 1 };
  cache.set(motion, made);
  return made;
}

/** Trace the body at a share of its time, with its mean position in the middle of a square. */
export function traceBody(
  context: CanvasRenderingContext2D,
  motion: Motion,
  share: number,
  [left, top, side]: readonly [number, number, number],
): void {
  const { chains, radius } = prepared(motion);
  const points = positionsAt(motion, share * (motion.header.frames - 1));
  const [x, y] = meanOf(points);
  const scale = (0.42 * side) / radius;
  context.beginPath();
  for (const chain of chains) {
    chain.forEach((node, i) => {
      const place = [
        left + side / 2 + scale * (points[node]![0] - x),
        top + side / 2 - scale * (points[node]![1] - y),
      ] as const;
      if (i === 0) context.moveTo(...place);
      else context.lineTo(...place);
    });
  }
}
