/** Pose streams: the recorded poses of one creature over its last two strokes, without the fluid. */

import { decodePlaces, floatsAt } from "./floats";
import { readHeader } from "./columns";

interface Header {
  creature: string;
  frames: number;
  nodes: number;
  /** The number of places in the path. */
  moments: number;
  edges: [number, number][];
  /** Cells of one unit. */
  scale: number;
  /** The length of the body at rest, in cells. */
  length: number;
  /** Steps before the first recorded stroke. */
  start: number;
  /** Steps at the last frame. */
  stop: number;
  /** Strokes that the frames span; 0 if they span the whole replay. */
  strokes: number;
  steps: number;
}

export interface PoseStream {
  header: Header;
  /** (moments, 2): mean positions at equal times of the whole simulation, in cells. */
  path: Float32Array;
  /** (frames, nodes, 2), unwrapped, in cells. */
  positions: Float32Array;
}

export function decodePoses(buffer: ArrayBuffer): PoseStream {
  const { header, start } = readHeader<Header>(buffer, "pose stream", "microcosmos-poses/1");
  const { frames, nodes, moments } = header;
  const first = start + 8 * moments;
  const needed = first + 8 * frames + 4 * frames * nodes;
  if (needed !== buffer.byteLength) {
    throw new Error(`pose stream: needs ${needed} bytes, got ${buffer.byteLength}`);
  }
  const { places } = decodePlaces(buffer, first, header);
  return { header, path: floatsAt(buffer, start, 2 * moments), positions: places };
}

/** The streams of a batch, each after its length. */
export function decodePoseBatch(buffer: ArrayBuffer): PoseStream[] {
  const view = new DataView(buffer);
  const streams: PoseStream[] = [];
  for (let at = 0; at < buffer.byteLength;) {
    const start = at + 4;
    at = start + view.getUint32(at, true);
    streams.push(decodePoses(buffer.slice(start, at)));
  }
  return streams;
}
