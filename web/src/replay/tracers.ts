/**
 * Passive particles in the recorded flow. All start in the first frame, so their positions depend
 * on the time alone, also when a user goes back.
 */

import type { Replay } from "../decode/replay";
import { type Point, wrap } from "./motion";

/** Cells per particle, and the largest number of particles. */
const [CELLS_PER_PARTICLE, MAX_COUNT] = [7, 1500];
/** The largest distance in one step of the integration, in cells. */
const MAX_STEP = 0.5;
/** Frames of a trail, and its pieces, which fade. */
const TRAIL_FRAMES = 32;
const TRAIL_PIECES = 4;

/** Particles in the water of a replay. */
export interface Particles {
  readonly replay: Replay;
  /** Their places (particle, 2) at a frame, unwrapped. */
  at(frame: number): Float32Array;
}

export class Tracers implements Particles {
  /** (particle, 2) for each frame so far, unwrapped. */
  private readonly tracks: Float32Array[];

  constructor(readonly replay: Replay) {
    const [width, height] = replay.header.size;
    this.tracks = [initialPositions(width, height)];
  }

  /** Positions at a frame. */
  at(frame: number): Float32Array {
    while (this.tracks.length <= frame) {
      this.tracks.push(this.advance(this.tracks.at(-1)!, this.tracks.length - 1));
    }
    return this.tracks[frame]!;
  }

  private advance(from: Float32Array, frame: number): Float32Array {
    const { every, velocity } = this.replay.header;
    const parts = Math.max(1, Math.ceil((every * velocity.scale) / MAX_STEP));
    const dt = every / parts;
    const to = from.slice();
    for (let i = 0; i < to.length; i += 2) {
      let [x, y] = [to[i]!, to[i + 1]!];
      for (let part = 0; part < parts; part++) {
        // The midpoint rule.
        const [u, v] = velocityAt(this.replay, frame + part / parts, x, y);
        const half = frame + (part + 0.5) / parts;
        const [mu, mv] = velocityAt(this.replay, half, x + 0.5 * dt * u, y + 0.5 * dt * v);
        [x, y] = [x + dt * mu, y + dt * mv];
      }
      [to[i], to[i + 1]] = [x, y];
    }
    return to;
  }
}

/** Quasirandom positions: the additive recurrence of the plastic number (M. Roberts, 2018). */
export function initialPositions(width: number, height: number, cells = CELLS_PER_PARTICLE): Float32Array {
  const count = Math.min(MAX_COUNT, Math.round((width * height) / cells));
  const plastic = 1.324717957244746;
  return Float32Array.from({ length: 2 * count }, (_, i) => {
    const share = (0.5 + ((i >> 1) + 1) / plastic ** (1 + (i & 1))) % 1;
    return share * (i & 1 ? height : width);
  });
}

/** The fluid's velocity in cells per step, interpolated between cells and frames. */
export function velocityAt({ header, velocity }: Replay, time: number, x: number, y: number): Point {
  const [width, height] = header.size;
  const cells = width * height;
  const before = Math.min(header.frames - 1, Math.floor(time));
  const after = Math.min(header.frames - 1, before + 1);
  const t = time - before;
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const [a, b] = [x - i, y - j];
  const [west, east] = [wrap(i, width) * height, wrap(i + 1, width) * height];
  const [south, north] = [wrap(j, height), wrap(j + 1, height)];
  const plane = (first: number) => {
    const at = (cell: number) => velocity[first + cell]!;
    const low = (1 - a) * at(west + south) + a * at(east + south);
    const high = (1 - a) * at(west + north) + a * at(east + north);
    return (1 - b) * low + b * high;
  };
  const unit = header.velocity.scale / 127;
  const part = (k: number) =>
    unit * ((1 - t) * plane((2 * before + k) * cells) + t * plane((2 * after + k) * cells));
  return [part(0), part(1)];
}

interface View {
  time: number;
  camera: Point;
  scale: number;
  colour: string;
}

/** Draw each particle with its trail, in the tile around the camera. */
export function drawTracers(context: CanvasRenderingContext2D, tracers: Particles, view: View) {
  const now = Math.floor(view.time);
  const first = Math.max(0, now - TRAIL_FRAMES);
  const share = view.time - now;
  const frames = [...Array(now - first + 1).keys()].map((k) => tracers.at(first + k));
  if (share > 0) frames.push(interpolated(tracers.at(now), tracers.at(now + 1), share));
  const shifts = shiftsOf(frames.at(-1)!, tracers, view);
  context.strokeStyle = context.fillStyle = view.colour;
  context.lineWidth = 1;
  const step = Math.max(1, Math.ceil((frames.length - 1) / TRAIL_PIECES));
  for (let start = 0; start < frames.length - 1; start += step) {
    context.globalAlpha = 0.12 + (0.4 * (start + step)) / frames.length;
    drawTrails(context, frames.slice(start, start + step + 1), shifts, view);
  }
  context.globalAlpha = 0.75;
  const heads = frames.at(-1)!;
  for (let i = 0; i < heads.length; i += 2) {
    const [x, y] = screen(heads, i, shifts, view);
    context.fillRect(x - 1, y - 1, 2, 2);
  }
  context.globalAlpha = 1;
}

function drawTrails(
  context: CanvasRenderingContext2D,
  frames: Float32Array[],
  shifts: Float32Array,
  view: View,
) {
  context.beginPath();
  for (let i = 0; i < shifts.length; i += 2) {
    frames.forEach((frame, k) => {
      const [x, y] = screen(frame, i, shifts, view);
      if (k === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
  }
  context.stroke();
}

/** Shifts in pixels that bring each particle into the tile around the camera. */
function shiftsOf(heads: Float32Array, tracers: Particles, { camera, scale }: View): Float32Array {
  const { size } = tracers.replay.header;
  return heads.map((value, i) => {
    const [side, middle] = [size[i & 1]!, camera[i & 1]!];
    const away = wrap(value - middle + side / 2, side) - value;
    return scale * (i & 1 ? side - away : away);
  });
}

function screen(frame: Float32Array, i: number, shifts: Float32Array, { scale }: View): Point {
  return [frame[i]! * scale + shifts[i]!, shifts[i + 1]! - frame[i + 1]! * scale];
}

function interpolated(a: Float32Array, b: Float32Array, t: number): Float32Array {
  return a.map((value, i) => (1 - t) * value + t * b[i]!);
}
