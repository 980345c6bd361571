/** The view of a replay, as the address holds it. */

import type { FieldName } from "./fields";

export interface ReplayView {
  field: FieldName | null;
  tracers: boolean;
  follow: boolean;
  speed: number;
}

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
export const DEFAULT_VIEW: ReplayView = { field: null, tracers: false, follow: true, speed: 1 };

const FIELDS = ["vorticity", "speed", "energy", "none"];

export function replayViewOf(query: URLSearchParams): ReplayView {
  const field = query.get("field");
  const speed = Number(query.get("pace"));
  return {
    field: FIELDS.includes(field!) ? (field as FieldName) : null,
    tracers: query.has("tracers"),
    follow: query.get("camera") !== "still",
    speed: SPEEDS.includes(speed) ? speed : 1,
  };
}

/** Changes of the address for changes of the view; defaults have no parameter. */
export function queryOf(change: Partial<ReplayView>): Record<string, string | null> {
  const words: Record<string, string | null> = {};
  if (change.field !== undefined) words.field = change.field;
  if (change.tracers !== undefined) words.tracers = change.tracers ? "" : null;
  if (change.follow !== undefined) words.camera = change.follow ? null : "still";
  if (change.speed !== undefined) words.pace = change.speed === 1 ? null : String(change.speed);
  return words;
}
