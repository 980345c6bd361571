/** The motion of one creature without the fluid: header, positions. */

import { readHeader, floats } from "./replay";

export interface MotionHeader {
  format: string;
  frames: number;
  /** Steps between frames. */
  every: number;
  steps: number;
  nodes: number;
  edges: [number, number][];
  size: [number, number];
}

export interface Motion {
  header: MotionHeader;
  /** (frames, nodes, 2), unwrapped lattice coordinates. */
  positions: Float32Array;
}

const FORMAT = "microcosmos-motion/1";

export function decodeMotion(buffer: ArrayBuffer): Motion {
  const { header, start } = readHeader<MotionHeader>(buffer, [FORMAT]);
  const count = header.frames * header.nodes * 2;
  if (start + 4 * count !== buffer.byteLength) {
    throw new Error(`motion: needs ${start + 4 * count} bytes, got ${buffer.byteLength}`);
  }
  return { header, positions: floats(buffer, start, count) };
}
