/** Motions: the recorded positions of one creature without the fluid. */

import { floatsAt } from "./floats";
import { type Header, type Replay, readHeader } from "./replay";

export interface Motion extends Pick<Replay, "positions"> {
  header: Pick<Header, "frames" | "every" | "steps" | "nodes" | "edges" | "size">;
}

export function decodeMotion(buffer: ArrayBuffer): Motion {
  const { header, start } = readHeader<Motion["header"]>(buffer, "microcosmos-motion/1");
  const count = header.frames * header.nodes * 2;
  if (start + 4 * count !== buffer.byteLength) {
    throw new Error(`motion: needs ${start + 4 * count} bytes, got ${buffer.byteLength}`);
  }
  return { header, positions: floatsAt(buffer, start, count) };
}
