/** Physical units of a creature; the same definitions as microcosmos.archive.physical. */

import type { Creature } from "../api/types";
import { number } from "../ui/format";
import type { Real } from "./real/quantity";
import { text } from "./text";

/** Kinematic viscosities at 20 °C, in m²/s, in order; sources in docs/physics.md. */
const FLUIDS: [name: string, viscosity: number][] = [
  ["acetone", 0.39e-6],
  ["water", 1.0e-6],
  ["ethanol", 1.5e-6],
  ["air", 15.1e-6],
  ["olive oil", 92e-6],
  ["glycerol", 1120e-6],
  ["honey", 7000e-6],
];
/** The largest ratio of two viscosities that are called alike. */
const LIKE = 1.5;

/** The steps of a stroke; null if a creature has none. */
export function strokeOf({ identity: { genome, world } }: Creature): number | null {
  const control = "control" in genome ? genome.control : genome;
  const { period, timer } = control as { period?: number; timer?: string };
  return world.fluid !== false && period && (timer ?? "sine-cosine") === "sine-cosine" ? period : null;
}

/** Rows of quantities; `cells` is the length of the body, `steps` the period of a stroke. */
export function physicalRows(
  { identity, measured }: Creature,
  real: Real,
  cells: number,
  steps: number,
): [name: string, value: string][] {
  const [cell, step] = [real.length / cells, real.period / steps];
  const fluid = (identity.world.viscosity as number) * (cell ** 2 / step);
  const { speed, reynolds } = (measured?.measures ?? {}) as { speed?: number; reynolds?: number };
  const rows: [string, string][] = [];
  if (speed !== undefined) rows.push([text.realSpeed, shown((speed / 1000) * (real.length / step), "m/s")]);
  if (reynolds !== undefined) rows.push([text.nodeSpeed, shown((reynolds * fluid) / real.length, "m/s")]);
  rows.push([text.realViscosity, `${number(fluid * 1e6)} mm²/s, ${like(fluid)}`]);
  rows.push([text.realCell, shown(cell, "m")], [text.realStep, shown(step, "s")]);
  return rows;
}

/** The fluid of that kinematic viscosity in m²/s, or the two between which it lies. */
export function like(viscosity: number): string {
  const distance = ([, value]: [string, number]) => Math.abs(Math.log(value / viscosity));
  const nearest = FLUIDS.reduce((a, b) => (distance(b) < distance(a) ? b : a));
  if (distance(nearest) <= Math.log(LIKE)) return text.asFluid(nearest[0]);
  const above = FLUIDS.findIndex(([, value]) => value > viscosity);
  if (above < 0) return text.timesFluid(number(viscosity / nearest[1]), nearest[0]);
  if (above === 0) return text.belowFluids(number(nearest[1] / viscosity), nearest[0]);
  return text.betweenFluids(FLUIDS[above - 1]![0], FLUIDS[above]![0]);
}

const PREFIXES: [scale: number, prefix: string][] = [
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

/** A quantity with a prefix, such as `270 µm/s`. */
export function shown(value: number, unit: string): string {
  if (value === 0) return `0 ${unit}`;
  const fits = ([scale]: [number, string]) => Math.abs(value) >= 0.9995 * scale;
  const [scale, prefix] = PREFIXES.find(fits) ?? PREFIXES.at(-1)!;
  return `${number(value / scale)} ${prefix}${unit}`;
}
