/** Why a search ended. */

import type { Json, Run, Spec } from "../api/types";
import { count, number } from "../ui/format";

const LIMITS: Record<string, (limit: number) => string> = {
  evaluations: (limit) => `its budget of ${count(limit)} evaluations was used up`,
  device_hours: (limit) => `its budget of ${number(limit)} device-hours was used up`,
  fitness: (limit) => `a creature had reached the fitness ${number(limit)}`,
};

/** A sentence; what was decided is told as `evaluations after generation 12`. */
export function endReasonOf({ summary, spec, generations }: Run): string {
  const told = typeof summary?.ended === "string" ? summary.ended : "";
  const [, name, generation] = /^(\w+) after generation (\d+)$/.exec(told) ?? [];
  const limit = name === undefined ? null : limitOf(spec, name);
  const reason = limit === null ? undefined : LIMITS[name!]?.(limit);
  if (reason) return `It ended after generation ${count(Number(generation))}: ${reason}.`;
  if (told) return `It ended early: ${told.replaceAll("_", " ")}.`;
  return generations === 1
    ? "It ended with its only generation."
    : `It ended with the last of its ${count(generations)} generations.`;
}

function limitOf(spec: Spec, name: string): number | null {
  const limit = (((spec.search as Spec | null)?.stop as Spec | null)?.[name] ?? null) as Json;
  return typeof limit === "number" ? limit : null;
}
