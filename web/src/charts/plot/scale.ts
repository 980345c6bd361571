/** Positions of values along an axis, and its ticks. */

export interface Scale {
  log: boolean;
  low: number;
  high: number;
}

/** The position of a value, from 0 to 1 along the axis. */
export function positionOf({ log, low, high }: Scale, value: number): number {
  if (!log) return (value - low) / (high - low);
  return (Math.log10(value) - Math.log10(low)) / (Math.log10(high) - Math.log10(low));
}

/** The value at a position, from 0 to 1 along the axis. */
export function valueAt({ log, low, high }: Scale, share: number): number {
  return log ? low * (high / low) ** share : low + (high - low) * share;
}

/** A logarithmic axis with room for the positive values and a margin. */
export function logAround(values: readonly number[]): Scale {
  const positive = values.filter((value) => value > 0);
  if (positive.length === 0) return { log: true, low: 1, high: 10 };
  const [low, high] = [Math.min(...positive), Math.max(...positive)];
  const beside = Math.max(1.25, (high / low) ** 0.035);
  return { log: true, low: low / beside, high: high * beside };
}

/** An axis from zero, or the lowest value, to the highest value, with a margin. */
export function fromZero(values: readonly number[]): Scale {
  const high = Math.max(0, ...values);
  const low = Math.min(0, ...values);
  const beside = 0.07 * (high - low || 1);
  return { log: false, low: low < 0 ? low - beside : 0, high: high + beside };
}

/** Round values, about `most` at most. */
export function ticksOf(scale: Scale, most: number): number[] {
  const ticks = scale.log ? logTicks(scale, most) : [];
  // Less than a decade may contain too few powers.
  return ticks.length < Math.min(2, most) ? linearTicks(scale, most) : ticks;
}

function linearTicks({ low, high }: Scale, most: number): number[] {
  const step = roundStep((high - low) / Math.max(1, most));
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** The next 1, 2 or 5 times a power of ten. */
export function roundStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= least * (1 - 1e-9))!;
}

/** Powers of ten, with 2 and 5 times them if there is room, or fewer. */
function logTicks({ low, high }: Scale, most: number): number[] {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const powers = Array.from({ length: last - first + 1 }, (_, i) => first + i);
  const inside = (factors: number[]) =>
    powers
      .flatMap((power) => factors.map((factor) => Number(`${factor}e${power}`)))
      .filter((value) => value >= low && value <= high);
  const fine = [[1, 2, 5], [1, 3], [1]].map(inside).find((found) => found.length <= most);
  if (fine) return fine;
  const tens = inside([1]);
  const every = Math.ceil(tens.length / most);
  return tens.filter((_, i) => i % every === 0);
}
