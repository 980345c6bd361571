/** The sparkline of a run, continued by events. */

const POINTS = 32;

/** The sparkline's even points over one more generation, at most 32 of them. */
export function withPoint(
  values: readonly number[],
  before: number,
  value: number | null,
  generation: number,
): number[] {
  if (value === null) return [...values];
  if (values.length < POINTS) return [...values, value];
  const step = (before - 1) / (values.length - 1);
  return Array.from({ length: POINTS }, (_, k) => {
    const place = (k * (generation - 1)) / (POINTS - 1);
    const i = Math.min(values.length - 1, Math.floor(place / step));
    const [from, to] = [values[i]!, values[i + 1] ?? value];
    const span = i === values.length - 1 ? generation - before : step;
    return from + ((to - from) * (place - i * step)) / span;
  });
}
