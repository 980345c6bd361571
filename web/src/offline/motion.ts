/** The recorded motion in a saved page: every pose, and the vorticity of fewer moments and squares of cells. */

import type { Replay } from "../decode/replay";
import { readHeader } from "../decode/header";

const FORMAT = "microcosmos-motion/1";
/** The most cells of the fluid along a side, and over all moments. */
const [SIDE, LEVELS] = [96, 400_000];
/** The largest number of a pose. */
const FINEST = 32_767;

type Header = Pick<
  Replay["header"],
  "creature" | "frames" | "every" | "steps" | "nodes" | "edges" | "size" | "solid"
> & {
  format: typeof FORMAT;
  vorticity: { scale: number };
  /** Moments of the fluid, evenly from the first to the last frame; cells of a square. */
  moments: number;
  square: number;
  origin: [number, number];
  /** Cells of one unit of a pose. */
  unit: number;
};

export function packMotion({ header, positions, vorticity }: Replay): Uint8Array<ArrayBuffer> {
  const { frames, size } = header;
  const square = Math.ceil(Math.max(...size) / SIDE);
  const [columns, rows] = size.map((side) => Math.ceil(side / square)) as [number, number];
  const moments = Math.min(frames, Math.max(2, Math.floor(LEVELS / (columns * rows))));
  const { origin, unit, poses } = quantised(positions);
  const { creature, every, steps, nodes, edges, solid } = header;
  const kept = { creature, frames, every, steps, nodes, edges, size, solid, vorticity: header.vorticity };
  const packed: Header = { format: FORMAT, ...kept, moments, square, origin, unit };
  const fluid = new Int8Array(moments * columns * rows);
  for (let moment = 0; moment < moments; moment++) {
    const frame = Math.round((moment * (frames - 1)) / Math.max(1, moments - 1));
    const plane = vorticity.subarray(frame * size[0] * size[1], (frame + 1) * size[0] * size[1]);
    fluid.set(squares(plane, size, square), moment * columns * rows);
  }
  return joined(packed, poses, fluid);
}

/** Positions as whole numbers, little-endian. */
function quantised(positions: Float32Array) {
  const axis = (k: number) => positions.filter((_, i) => i % 2 === k);
  const bounds = [0, 1].map((k) =>
    axis(k).reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)] as const, [
      Infinity,
      -Infinity,
    ] as const),
  );
  const origin = bounds.map(([low, high]) => (low + high) / 2) as [number, number];
  const unit = Math.max(...bounds.map(([low, high]) => high - low)) / 2 / FINEST || 1;
  const poses = new DataView(new ArrayBuffer(2 * positions.length));
  positions.forEach((x, i) => poses.setInt16(2 * i, Math.round((x - origin[i % 2]!) / unit), true));
  return { origin, unit, poses: new Uint8Array(poses.buffer) };
}

/** Means of a plane over squares of cells. */
function squares(plane: Int8Array, [width, height]: [number, number], square: number): Int8Array {
  if (square === 1) return plane;
  const rows = Math.ceil(height / square);
  const found = new Int8Array(Math.ceil(width / square) * rows);
  for (let column = 0; column * square < width; column++) {
    for (let row = 0; row < rows; row++) {
      let [sum, count] = [0, 0];
      for (let x = column * square; x < Math.min(width, (column + 1) * square); x++) {
        for (let y = row * square; y < Math.min(height, (row + 1) * square); y++) {
          sum += plane[x * height + y]!;
          count++;
        }
      }
      found[column * rows + row] = Math.round(sum / count);
    }
  }
  return found;
}

function joined(header: Header, poses: Uint8Array, fluid: Int8Array): Uint8Array<ArrayBuffer> {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const file = new Uint8Array(4 + text.length + poses.length + fluid.length);
  new DataView(file.buffer).setUint32(0, text.length, true);
  file.set(text, 4);
  file.set(poses, 4 + text.length);
  file.set(new Uint8Array(fluid.buffer), 4 + text.length + poses.length);
  return file;
}

/** A replay of its motion: the vorticity of other moments and cells is interpolated. */
export function unpackMotion(buffer: ArrayBuffer): Replay {
  const { header, start } = readHeader<Header>(buffer, "motion", FORMAT);
  const { frames, nodes, moments, origin, unit } = header;
  const poses = new DataView(buffer, start);
  const positions = Float32Array.from(
    { length: 2 * frames * nodes },
    (_, i) => origin[i % 2]! + unit * poses.getInt16(2 * i, true),
  );
  const fluid = new Int8Array(buffer, start + 2 * positions.length);
  const cells = header.size[0] * header.size[1];
  const vorticity = new Int8Array(frames * cells);
  for (let frame = 0; frame < frames; frame++) {
    const moment = (frame * (moments - 1)) / Math.max(1, frames - 1);
    vorticity.set(plane(header, fluid, moment), frame * cells);
  }
  const nothing = { angles: new Float32Array(0), lengths: new Float32Array(0), velocity: new Int8Array(0) };
  const absent = { joints: [], velocity: { scale: 0 }, energy: { scale: 0, frames: 0 } };
  const fitness = { recorded: null, replayed: null, difference: null };
  return {
    header: { ...header, ...absent, fitness },
    positions,
    vorticity,
    ...nothing,
    energy: new Uint8Array(0),
  };
}

/** The vorticity of all cells at a moment, which may lie between two. */
function plane({ size, square, moments }: Header, fluid: Int8Array, moment: number): Int8Array {
  const [width, height] = size;
  const [columns, rows] = size.map((side) => Math.ceil(side / square)) as [number, number];
  const first = Math.min(moments - 1, Math.floor(moment));
  const [old, next] = [first, Math.min(moments - 1, first + 1)].map((k) => k * columns * rows);
  const t = moment - first;
  const at = (column: number, row: number) => {
    const place = (column % columns) * rows + (row % rows);
    return (1 - t) * fluid[old! + place]! + t * fluid[next! + place]!;
  };
  const found = new Int8Array(width * height);
  for (let x = 0; x < width; x++) {
    const [column, a] = between(x, square, columns);
    for (let y = 0; y < height; y++) {
      const [row, b] = between(y, square, rows);
      const low = (1 - a) * at(column, row) + a * at(column + 1, row);
      const high = (1 - a) * at(column, row + 1) + a * at(column + 1, row + 1);
      found[x * height + y] = Math.round((1 - b) * low + b * high);
    }
  }
  return found;
}

/** The square whose middle lies before the middle of a cell, and the way to the next one. */
function between(cell: number, square: number, count: number): [square: number, share: number] {
  const place = (cell + 0.5) / square - 0.5 + count;
  return [Math.floor(place), place - Math.floor(place)];
}
