/** How fast a run goes, from its recent generations; events carry no rate of their own. */

import type { GenerationEvent, Run } from "../api/types";

/** Generations that the rate is measured over: enough to be calm, few enough to be true. */
const RECENT = 12;
const POINTS = 32;

export type RateWindow = readonly Pick<GenerationEvent, "generation" | "evaluations" | "seconds">[];

export function withEvent(pace: RateWindow, event: GenerationEvent): RateWindow {
  const last = pace.at(-1);
  const kept = last && last.generation < event.generation ? pace : [];
  return [...kept.slice(1 - RECENT), event];
}

/** Evaluations a second and the seconds left, where two generations are known. */
export function rateOf(pace: RateWindow, run: Run): Partial<Run> {
  const [first, last] = [pace[0], pace.at(-1)];
  if (!first || !last || last.seconds <= first.seconds) return {};
  const rate = (last.evaluations - first.evaluations) / (last.seconds - first.seconds);
  const left = (last.evaluations / last.generation) * (run.generations - last.generation);
  return { evaluations_per_second: rate, eta_seconds: rate > 0 ? left / rate : null };
}

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
