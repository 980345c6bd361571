/** Why a search ended. */

import type { Json, Run, Spec } from "../api/types";
import { count, number } from "../ui/format";
import { text } from "./text";

const LIMITS: Record<string, (limit: number) => string> = {
  evaluations: (limit) => text.budgetEvaluations(count(limit)),
  device_hours: (limit) => text.budgetHours(number(limit)),
  fitness: (limit) => text.fitnessReached(number(limit)),
};

/** A sentence from `summary.ended`, such as `evaluations after generation 12`. */
export function endReasonOf({ summary, spec, generations }: Run): string {
  const told = typeof summary?.ended === "string" ? summary.ended : "";
  const [, name, generation] = /^(\w+) after generation (\d+)$/.exec(told) ?? [];
  const limit = name === undefined ? null : limitOf(spec, name);
  const reason = limit === null ? undefined : LIMITS[name!]?.(limit);
  if (reason) return text.endedAfter(count(Number(generation)), reason);
  if (told) return text.endedEarly(told.replaceAll("_", " "));
  return generations === 1 ? text.completedOne : text.completed(count(generations));
}

function limitOf(spec: Spec, name: string): number | null {
  const limit = (((spec.search as Spec | null)?.stop as Spec | null)?.[name] ?? null) as Json;
  return typeof limit === "number" ? limit : null;
}
