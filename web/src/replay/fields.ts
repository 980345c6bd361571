/** Fields of the fluid: integer planes, units and colours, painted around a camera. */

import type { Replay } from "../decode/replay";
import { type Rgb, diverging, lut, viridis } from "../ui/colours";
import type { Theme } from "../ui/canvas";
import { text } from "./text";
import { type Point, wrap } from "./motion";

export type FieldName = "vorticity" | "speed" | "energy" | "none";

export interface Field {
  name: FieldName;
  title: string;
  unit: string;
  /** Values at the ends of the colour map. */
  range: [number, number];
  colour: (t: number) => Rgb;
  /** Theme of the field as a background; ink has the contrasting colour. */
  background: Theme;
  /** Levels (width, height) of a frame; level + `zero` is the index in the colour lut. */
  plane: (replay: Replay, frame: number) => ArrayLike<number>;
  zero: number;
  /** The value of one level in this replay. */
  quantum: (replay: Replay) => number;
}

/** The fields that all replays contain. */
export function fieldsOf(replays: Replay[]): FieldName[] {
  const energy = replays.every(({ header }) => header.energy.frames);
  const fluid = replays.some((replay) => vorticityLimit(replay) > 0);
  return [
    ...(fluid ? (["vorticity", "speed"] as const) : []),
    ...(energy ? (["energy"] as const) : []),
    "none",
  ];
}

/** A field with one colour scale for all replays; null for no field. */
export function fieldOf(name: FieldName, replays: Replay[], theme: Theme): Field | null {
  if (name === "vorticity") return vorticityOf(replays, theme);
  if (name === "speed") return speedOf(replays);
  return name === "energy" ? energyOf(replays, theme) : null;
}

function vorticityOf(replays: Replay[], theme: Theme): Field {
  const limit = Math.max(...replays.map(vorticityLimit));
  return {
    name: "vorticity",
    title: text.fields.vorticity,
    unit: "1/step",
    range: [-limit, limit],
    colour: (t) => diverging(2 * t - 1, theme),
    background: theme,
    plane: ({ vorticity, header }, frame) => planeOf(vorticity, header, frame),
    zero: 127,
    quantum: ({ header }) => header.vorticity.scale / 127,
  };
}

function speedOf(replays: Replay[]): Field {
  const planes = new Map(replays.map((replay) => [replay, speedPlanes(replay)]));
  const limits = replays.map((replay) => speedLimit(replay, planes.get(replay)!));
  return {
    name: "speed",
    title: text.fields.speed,
    unit: "cells/step",
    range: [0, Math.max(...limits)],
    colour: viridis,
    background: "dark",
    plane: (replay, frame) => planes.get(replay)!(frame),
    zero: 0,
    quantum: quantumOfSpeed,
  };
}

function energyOf(replays: Replay[], theme: Theme): Field {
  return {
    name: "energy",
    title: text.fields.energy,
    unit: text.density,
    range: [0, Math.max(...replays.map(({ header }) => header.energy.scale))],
    colour: (t) => diverging(0.85 * t, theme),
    background: theme,
    plane: ({ energy, header }, frame) => planeOf(energy, header, Math.min(frame, header.energy.frames - 1)),
    zero: 0,
    quantum: ({ header }) => header.energy.scale / 255,
  };
}

function planeOf<T extends Int8Array | Uint8Array>(levels: T, { size }: Replay["header"], frame: number) {
  const cells = size[0] * size[1];
  return levels.subarray(frame * cells, (frame + 1) * cells);
}

/** The highest level of speed is that of both velocity components at their largest. */
const quantumOfSpeed = ({ header }: Replay) => (Math.SQRT2 * header.velocity.scale) / 255;

/** |u| of each frame, computed on demand. */
function speedPlanes(replay: Replay): (frame: number) => Uint8Array {
  const { header, velocity } = replay;
  const cells = header.size[0] * header.size[1];
  const levels = header.velocity.scale / 127 / quantumOfSpeed(replay);
  const compute = (frame: number) => {
    const start = 2 * frame * cells;
    return Uint8Array.from({ length: cells }, (_, i) => {
      const [x, y] = [velocity[start + i]!, velocity[start + cells + i]!];
      return Math.min(255, Math.round(levels * Math.sqrt(x * x + y * y)));
    });
  };
  const planes: Uint8Array[] = [];
  return (frame) => (planes[frame] ??= compute(frame));
}

/** The 99th percentile of speed, over a few frames. */
function speedLimit(replay: Replay, plane: (frame: number) => Uint8Array): number {
  const last = replay.header.frames - 1;
  const samples = [0.25, 0.5, 0.75, 1].map((share) => plane(Math.round(share * last)));
  const values = Uint8Array.from(samples.flatMap((plane) => [...plane])).sort();
  return (values[Math.floor(0.99 * values.length)]! || 1) * quantumOfSpeed(replay);
}

/** The 99th percentile of nonzero absolute vorticity; 0 if there is none. */
function vorticityLimit({ vorticity, header }: Replay): number {
  const counts = new Array<number>(129).fill(0);
  for (const value of vorticity) counts[Math.abs(value)]!++;
  const moving = vorticity.length - counts[0]!;
  if (moving === 0) return 0;
  let above = 0;
  for (let level = 128; level > 1; level--) {
    above += counts[level]!;
    if (above > moving / 100) return (level / 127) * header.vorticity.scale;
  }
  return header.vorticity.scale / 127;
}

/** The colour of each level, starting at −`zero`. */
export function coloursOf(field: Field, replay: Replay): Uint32Array {
  const [low, high] = field.range;
  const quantum = field.quantum(replay);
  const count = field.zero ? 2 * field.zero + 1 : 256;
  const at = (level: number) => ((level - field.zero) * quantum - low) / (high - low);
  return lut(field.colour, count, [at(0), at(count - 1)]);
}

/** Cells drawn beyond the view, so that smoothing does not reach the image's edge. */
const MARGIN = 2;

export class FluidPainter {
  private readonly image: ImageData;
  private readonly canvas: OffscreenCanvas;
  private readonly colours: Uint32Array;

  constructor(
    private readonly replay: Replay,
    private readonly field: Field,
  ) {
    const [width, height] = replay.header.size;
    this.canvas = new OffscreenCanvas(width + 2 * MARGIN, height + 2 * MARGIN);
    this.image = new ImageData(this.canvas.width, this.canvas.height);
    this.colours = coloursOf(field, replay);
  }

  /** Fill a context of `scale` pixels per cell with the flow at `time` around `camera`. */
  paint(context: CanvasRenderingContext2D, time: number, camera: Point, scale: number): void {
    const [width, height] = this.replay.header.size;
    const left = camera[0] - width / 2;
    const bottom = camera[1] - height / 2;
    const [x0, y0] = [Math.floor(left) - 1, Math.floor(bottom) - 1];
    this.fill(time, x0, y0);
    this.canvas.getContext("2d")!.putImageData(this.image, 0, 0);
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    const top = bottom + height - (y0 + this.canvas.height - 0.5);
    context.drawImage(
      this.canvas,
      (x0 - 0.5 - left) * scale,
      top * scale,
      this.canvas.width * scale,
      this.canvas.height * scale,
    );
  }

  private fill(time: number, x0: number, y0: number): void {
    const { size, frames } = this.replay.header;
    const [width, height] = size;
    const before = Math.min(frames - 1, Math.floor(time));
    const after = Math.min(frames - 1, before + 1);
    const t = time - before;
    const { zero } = this.field;
    const [old, next] = [before, after].map((frame) => this.field.plane(this.replay, frame));
    const pixels = new Uint32Array(this.image.data.buffer);
    const { width: columns, height: rows } = this.canvas;
    for (let column = 0; column < columns; column++) {
      const x = wrap(x0 + column, width);
      const first = x * height;
      for (let row = 0; row < rows; row++) {
        const y = wrap(y0 + rows - 1 - row, height);
        const value = (1 - t) * old![first + y]! + t * next![first + y]!;
        pixels[row * columns + column] = this.colours[Math.round(value) + zero]!;
      }
    }
  }
}
