/** A small body on the move: prepared once, then drawn many times a second. */

import type { Motion } from "../decode/motion";
import { chainsOf } from "./motion";

interface Prepared {
  chains: number[][];
  /** (frames, 2): the body's mean position. */
  middles: Float32Array;
  /** The farthest that a node is from the middle, in cells. */
  reach: number;
}

const known = new WeakMap<Motion, Prepared>();

function prepared(motion: Motion): Prepared {
  const there = known.get(motion);
  if (there) return there;
  const made = prepare(motion);
  known.set(motion, made);
  return made;
}

function prepare({ header, positions }: Motion): Prepared {
  const { frames, nodes, edges } = header;
  const middles = new Float32Array(2 * frames);
  let reach = 0;
  for (let frame = 0; frame < frames; frame++) {
    const at = 2 * frame * nodes;
    let [x, y] = [0, 0];
    for (let k = at; k < at + 2 * nodes; k += 2) {
      x += positions[k]! / nodes;
      y += positions[k + 1]! / nodes;
    }
    middles.set([x, y], 2 * frame);
    for (let k = at; k < at + 2 * nodes; k += 2) {
      reach = Math.max(reach, Math.hypot(positions[k]! - x, positions[k + 1]! - y));
    }
  }
  return { chains: chainsOf(edges), middles, reach: reach || 1 };
}

/** Traces the body in a square, its middle in the middle, as it is at a share of its time. */
export function traceBody(
  context: CanvasRenderingContext2D,
  motion: Motion,
  share: number,
  [left, top, side]: readonly [number, number, number],
): void {
  const { chains, middles, reach } = prepared(motion);
  const { frames, nodes } = motion.header;
  const time = share * (frames - 1);
  const before = Math.min(frames - 1, Math.floor(time));
  const after = Math.min(frames - 1, before + 1);
  const t = time - before;
  const scale = (0.42 * side) / reach;
  const place = (values: Float32Array, a: number, b: number) => (1 - t) * values[a]! + t * values[b]!;
  const x0 = left + side / 2 - scale * place(middles, 2 * before, 2 * after);
  const y0 = top + side / 2 + scale * place(middles, 2 * before + 1, 2 * after + 1);
  context.beginPath();
  for (const chain of chains) {
    chain.forEach((node, i) => {
      const [a, b] = [2 * (before * nodes + node), 2 * (after * nodes + node)];
      const x = x0 + scale * place(motion.positions, a, b);
      const y = y0 - scale * place(motion.positions, a + 1, b + 1);
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
  }
}
