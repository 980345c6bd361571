/** Fields of the fluid: integer planes, units and colours. */

import type { Replay } from "../decode/replay";
import { type Rgb, diverging, lut, viridis } from "../ui/colours";
import type { Theme } from "../ui/canvas";
import { text } from "./text";

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
export function vorticityLimit({ vorticity, header }: Replay): number {
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
