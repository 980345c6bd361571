/** The recorded motion of one creature, what drives it, and the fluid around it. */

export interface Header {
  format: string;
  creature: string;
  frames: number;
  every: number;
  steps: number;
  nodes: number;
  edges: [number, number][];
  /** Pairs of edges. */
  joints?: [number, number][];
  size: [number, number];
  vorticity: { scale: number };
  velocity?: { scale: number };
  energy?: { scale: number; frames: number };
  /** Replayed is null where the fitness is of users' own and its module was not to be had. */
  fitness: { recorded: number | null; replayed: number | null; difference: number | null };
  device: string;
}

export interface Replay {
  header: Header;
  /** (frames, nodes, 2), unwrapped lattice coordinates. */
  positions: Float32Array;
  /** (frames, width, height); value / 127 * scale is the vorticity. */
  vorticity: Int8Array;
  /** Absent in the first format. */
  drive?: Drive;
}

export interface Drive {
  /** (frames, joints), in rad, as applied in the step before the frame. */
  angles: Float32Array;
  /** (frames, edges), in cells. */
  lengths: Float32Array;
  /** (frames, 2, width, height); value / 127 * scale is in cells a step. */
  velocity: Int8Array;
  /** (planes, width, height); value / 255 * scale. One plane a frame, one for all, or none. */
  energy: Uint8Array;
}

const FORMATS = ["microcosmos-replay/1", "microcosmos-replay/2"];

export function decodeReplay(buffer: ArrayBuffer): Replay {
  const { header, start } = readHeader<Header>(buffer, FORMATS);
  const { frames, nodes, size, joints, edges, energy } = header;
  const cells = size[0] * size[1];
  const driven = header.format !== FORMATS[0];
  const counts = [frames * nodes * 2, ...(driven ? [frames * joints!.length, frames * edges.length] : [])];
  const planes = driven ? [frames, 2 * frames, energy!.frames] : [frames];
  const whole = 4 * sum(counts) + cells * sum(planes);
  let at = start;
  if (at + whole !== buffer.byteLength) {
    throw new Error(`replay: ${frames} frames need ${start + whole} bytes, got ${buffer.byteLength}`);
  }
  const after = (bytes: number) => (at += bytes) - bytes;
  const [positions, angles, lengths] = counts.map((count) => floats(buffer, after(4 * count), count));
  const vorticity = new Int8Array(buffer, after(frames * cells), frames * cells);
  if (!driven) return { header, positions: positions!, vorticity };
  const velocity = new Int8Array(buffer, after(2 * frames * cells), 2 * frames * cells);
  const packets = new Uint8Array(buffer, at, energy!.frames * cells);
  const drive = { angles: angles!, lengths: lengths!, velocity, energy: packets };
  return { header, positions: positions!, vorticity, drive };
}

function sum(values: number[]): number {
  return values.reduce((total, value) => total + value, 0);
}

/** The JSON behind its own length, and where it ends. */
export function readHeader<T extends { format: string }>(buffer: ArrayBuffer, formats: string[]) {
  const length = new DataView(buffer).getUint32(0, true);
  if (4 + length > buffer.byteLength) {
    throw new Error(`replay: a header of ${length} bytes does not fit in ${buffer.byteLength}`);
  }
  const header: T = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  if (!formats.includes(header.format)) {
    throw new Error(`replay: format must be ${formats.join(" or ")}, got ${header.format}`);
  }
  return { header, start: 4 + length };
}

/** Little-endian floats, whatever the machine's own order. */
export function floats(buffer: ArrayBuffer, start: number, count: number): Float32Array {
  const view = new DataView(buffer, start, 4 * count);
  const values = new Float32Array(count);
  for (let i = 0; i < count; i++) values[i] = view.getFloat32(4 * i, true);
  return values;
}
