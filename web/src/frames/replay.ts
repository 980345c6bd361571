/** The recorded motion of one creature: header, positions, vorticity. */

export interface Header {
  format: string;
  creature: string;
  frames: number;
  every: number;
  steps: number;
  nodes: number;
  edges: [number, number][];
  size: [number, number];
  vorticity: { scale: number };
  fitness: { recorded: number | null; replayed: number; difference: number | null };
  device: string;
}

export interface Replay {
  header: Header;
  /** (frames, nodes, 2), unwrapped lattice coordinates. */
  positions: Float32Array;
  /** (frames, width, height); value / 127 * scale is the vorticity. */
  vorticity: Int8Array;
}

const FORMAT = "microcosmos-replay/1";

export function decodeReplay(buffer: ArrayBuffer): Replay {
  const length = new DataView(buffer).getUint32(0, true);
  if (4 + length > buffer.byteLength) {
    throw new Error(`replay: a header of ${length} bytes does not fit in ${buffer.byteLength}`);
  }
  const header: Header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  if (header.format !== FORMAT) {
    throw new Error(`replay: format must be ${FORMAT}, got ${header.format}`);
  }
  const { frames, nodes, size } = header;
  const start = 4 + length;
  const bytes = frames * nodes * 2 * 4;
  const cells = frames * size[0] * size[1];
  if (start + bytes + cells !== buffer.byteLength) {
    throw new Error(
      `replay: ${frames} frames need ${start + bytes + cells} bytes, got ${buffer.byteLength}`,
    );
  }
  return {
    header,
    positions: floats(buffer, start, frames * nodes * 2),
    vorticity: new Int8Array(buffer, start + bytes, cells),
  };
}

/** Little-endian floats, whatever the machine's own order. */
function floats(buffer: ArrayBuffer, start: number, count: number): Float32Array {
  const view = new DataView(buffer, start, 4 * count);
  const values = new Float32Array(count);
  for (let i = 0; i < count; i++) values[i] = view.getFloat32(4 * i, true);
  return values;
}
