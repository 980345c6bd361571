/** Motion: a replay that the server or the library made small, for pages without a server. */

import { decodePlaces } from "./floats";
import { readHeader } from "./columns";
import { type Replay, motionOnly } from "./replay";

type Header = Pick<
  Replay["header"],
  "creature" | "frames" | "every" | "steps" | "nodes" | "edges" | "size" | "solid" | "vorticity"
> & {
  /** Moments of the fluid, evenly from the first to the last frame; cells of a square. */
  moments: number;
  square: number;
  /** Cells of one unit of a pose. */
  scale: number;
};

/** A replay of its motion: the vorticity of other moments and cells is interpolated. */
export function decodeMotion(buffer: ArrayBuffer): Replay {
  const { header, start } = readHeader<Header>(buffer, "motion", "microcosmos-motion/1");
  const { frames, moments } = header;
  const { places: positions, end } = decodePlaces(buffer, start, header);
  const fluid = new Int8Array(buffer, end);
  const cells = header.size[0] * header.size[1];
  const vorticity = new Int8Array(frames * cells);
  for (let frame = 0; frame < frames; frame++) {
    const moment = (frame * (moments - 1)) / Math.max(1, frames - 1);
    vorticity.set(plane(header, fluid, moment), frame * cells);
  }
  return motionOnly(header, { positions, vorticity });
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
