/** The view of a replay: in the address, its options, and the legend of its field. */

import { setQuery } from "../store/router";
import { ColourBar } from "../ui/ColourBar";
import { Check, Segments } from "../ui/Select";
import { css } from "../ui/colours";
import { number } from "../ui/format";
import type { Field, FieldName } from "./fields";
import { text } from "./text";

export interface ReplayView {
  field: FieldName | null;
  tracers: boolean;
  follow: boolean;
  speed: number;
}

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];

const FIELDS = ["vorticity", "speed", "energy", "none"];

export function replayViewOf(query: URLSearchParams): ReplayView {
  const field = query.get("field");
  const speed = Number(query.get("speed"));
  return {
    field: FIELDS.includes(field!) ? (field as FieldName) : null,
    tracers: query.has("tracers"),
    follow: query.get("camera") !== "still",
    speed: SPEEDS.includes(speed) ? speed : 1,
  };
}

/** Changes of the address for changes of the view; defaults have no parameter. */
export function queryOf(change: Partial<ReplayView>): Record<string, string | null> {
  const parameters: Record<string, string | null> = {};
  if (change.field !== undefined) parameters.field = change.field;
  if (change.tracers !== undefined) parameters.tracers = change.tracers ? "" : null;
  if (change.follow !== undefined) parameters.camera = change.follow ? null : "still";
  if (change.speed !== undefined) parameters.speed = change.speed === 1 ? null : String(change.speed);
  return parameters;
}

export const changeView = (change: Partial<ReplayView>) => setQuery(queryOf(change));

interface Props {
  names: FieldName[];
  name: FieldName;
  view: ReplayView;
}

export function ViewOptions({ names, name, view }: Props) {
  return (
    <div class="row">
      {names.length > 1 && (
        <Segments
          label={text.field}
          choices={names.map((each) => [each, text.fields[each]] as const)}
          value={name}
          onSelect={(field) => changeView({ field })}
        />
      )}
      {names.includes("speed") && (
        <Check title={text.tracers} on={view.tracers} onChange={(tracers) => changeView({ tracers })} />
      )}
      <Check title={text.follow} on={view.follow} onChange={(follow) => changeView({ follow })} />
    </div>
  );
}

export function FieldLegend({ field: { title, unit, range, colour } }: { field: Field }) {
  const [low, high] = range;
  const numbers = [low, (low + high) / 2, high].map((value) => number(value, 2));
  return (
    <ColourBar
      name={`${title} (${unit})`}
      label={text.legend(title, numbers[0], numbers[2], unit)}
      colourAt={(share) => css(colour(share))}
      numbers={numbers}
    />
  );
}
