/** Lengths and times as people type them; the same grammar as microcosmos.archive.quantities. */

import { text } from "./text";

/** Real length of the body in metres, and period of a stroke in seconds. */
export interface Real {
  length: number;
  period: number;
}

/** A quantity as typed, such as `1 mm`; empty where none is given. */
export interface Typed {
  length: string;
  period: string;
}

const LENGTHS: Record<string, number> = {
  km: 1e3,
  m: 1,
  cm: 1e-2,
  mm: 1e-3,
  um: 1e-6,
  µm: 1e-6,
  μm: 1e-6,
  nm: 1e-9,
};
const TIMES: Record<string, number> = { min: 60, s: 1, ms: 1e-3, us: 1e-6, µs: 1e-6, μs: 1e-6 };

export const lengthOf = (typed: string) => quantity(typed, LENGTHS);
export const periodOf = (typed: string) => quantity(typed, TIMES);

/** In m and s: powers of quantities beyond overflow. */
const [SMALLEST, LARGEST] = [1e-12, 1e6];

/** A number above 0 with a known unit, in SI units; null for any other text. */
function quantity(typed: string, units: Record<string, number>): number | null {
  const [, digits, unit] = /^\s*([\d.]+(?:e[+-]?\d+)?)\s*([a-zµμ]+)\s*$/.exec(typed) ?? [];
  const value = Number(digits) * (units[unit ?? ""] ?? NaN);
  return value >= SMALLEST && value <= LARGEST ? value : null;
}

/** Both quantities in SI units; null unless both are given and have a known unit. */
export function realOf(typed: Typed): Real | null {
  const [length, period] = [lengthOf(typed.length), periodOf(typed.period)];
  return length === null || period === null ? null : { length, period };
}

/** A sentence on what is wrong or missing; null where both are given, or none is. */
export function problemOf({ length, period }: Typed): string | null {
  if (length !== "" && lengthOf(length) === null) return text.wrongLength;
  if (period !== "" && periodOf(period) === null) return text.wrongPeriod;
  if (length === "" && period !== "") return text.needsLength;
  if (period === "" && length !== "") return text.needsPeriod;
  return null;
}
