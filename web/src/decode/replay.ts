/** Replays: the recorded motion of one creature, its drive and the fluid around it. */

import { floatsAt } from "./floats";
import { readHeader } from "./columns";

export interface Header {
  creature: string;
  frames: number;
  /** Steps between frames. */
  every: number;
  steps: number;
  nodes: number;
  edges: [number, number][];
  /** Pairs of edges. */
  joints: [number, number][];
  size: [number, number];
  vorticity: { scale: number };
  velocity: { scale: number };
  energy: { scale: number; frames: number };
  /** Lengths of runs of cells, in the order of planes, that are fluid, solid, fluid and so on. */
  solid?: number[];
  /** `replayed` is null if the plug-in of the task was not loaded. */
  fitness: { recorded: number | null; replayed: number | null; difference: number | null };
}

export interface Replay {
  header: Header;
  /** (frames, nodes, 2), unwrapped lattice coordinates. */
  positions: Float32Array;
  /** Rest angles (frames, joints), in rad, as applied in the step before the frame. */
  angles: Float32Array;
  /** Rest lengths (frames, edges), in cells. */
  lengths: Float32Array;
  /** (frames, width, height); value / 127 * scale is the vorticity. */
  vorticity: Int8Array;
  /** (frames, 2, width, height); value / 127 * scale is in cells per step. */
  velocity: Int8Array;
  /** (planes, width, height); value / 255 * scale. One plane per frame, one for all, or none. */
  energy: Uint8Array;
}

export function decodeReplay(buffer: ArrayBuffer): Replay {
  const { header, start } = readHeader<Header>(buffer, "replay", "microcosmos-replay/2");
  const { frames, nodes, size, joints, edges, energy } = header;
  const cells = size[0] * size[1];
  const floatCounts = [2 * nodes, joints.length, edges.length].map((count) => frames * count);
  const byteCounts = [frames, 2 * frames, energy.frames].map((planes) => planes * cells);
  const needed = start + 4 * sum(floatCounts) + sum(byteCounts);
  if (needed !== buffer.byteLength) {
    throw new Error(`replay: ${frames} frames need ${needed} bytes, got ${buffer.byteLength}`);
  }
  let at = start;
  const after = (bytes: number) => (at += bytes) - bytes;
  const [positions, angles, lengths] = floatCounts.map((count) => floatsAt(buffer, after(4 * count), count));
  const [vorticity, velocity] = byteCounts.map((count) => new Int8Array(buffer, after(count), count));
  const packets = new Uint8Array(buffer, at - byteCounts[2]!, byteCounts[2]);
  const floats = { positions: positions!, angles: angles!, lengths: lengths! };
  return { header, ...floats, vorticity: vorticity!, velocity: velocity!, energy: packets };
}

type Moving = Pick<Replay, "positions" | "vorticity"> & Partial<Replay>;

/** A replay without what moves the body, and without any field that is not given. */
export function motionOnly(
  header: Omit<Header, "joints" | "velocity" | "energy" | "fitness"> & Partial<Header>,
  arrays: Moving,
): Replay {
  const fitness = { recorded: null, replayed: null, difference: null };
  const absent = { joints: [], velocity: { scale: 0 }, energy: { scale: 0, frames: 0 }, fitness };
  const [angles, lengths] = [new Float32Array(0), new Float32Array(0)];
  const fields = { velocity: new Int8Array(0), energy: new Uint8Array(0) };
  return { header: { ...absent, ...header }, angles, lengths, ...fields, ...arrays };
}

/** The solid cells of runs in a world so high, as columns of neighbours along y: x, the first y, and how many. */
export function solidColumns(solid: number[], height: number): [number, number, number][] {
  const columns: [number, number, number][] = [];
  let at = 0;
  solid.forEach((length, run) => {
    const end = at + length;
    while (run % 2 === 1 && at < end) {
      const y = at % height;
      const count = Math.min(end - at, height - y);
      columns.push([Math.floor(at / height), y, count]);
      at += count;
    }
    at = end;
  });
  return columns;
}

const sum = (values: number[]) => values.reduce((total, value) => total + value, 0);
