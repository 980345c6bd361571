/** Controls of a replay, and the legend of its field. */

import { Check, Segments, Select } from "../ui/Select";
import { ColourBar } from "../ui/ColourBar";
import { css } from "../ui/colours";
import { number } from "../ui/format";
import type { Field, FieldName } from "./fields";
import { type ReplayView, SPEEDS } from "./replayView";
import { text } from "./text";

const SPEED_CHOICES = SPEEDS.map((speed) => [String(speed), `${speed} ×`] as const);

export function Speed({ value, onChange }: { value: number; onChange: (speed: number) => void }) {
  return (
    <Select
      title={text.speed}
      choices={SPEED_CHOICES}
      value={String(value)}
      onChange={(speed) => onChange(Number(speed))}
    />
  );
}

interface Props {
  names: FieldName[];
  name: FieldName;
  view: ReplayView;
  change: (part: Partial<ReplayView>) => void;
}

export function LookChoice({ names, name, view, change }: Props) {
  return (
    <div class="row">
      {names.length > 1 && (
        <Segments
          label={text.field}
          choices={names.map((each) => [each, text.fields[each]] as const)}
          value={name}
          onSelect={(field) => change({ field })}
        />
      )}
      {names.includes("speed") && (
        <Check title={text.tracers} on={view.tracers} onChange={(tracers) => change({ tracers })} />
      )}
      <Check title={text.follow} on={view.follow} onChange={(follow) => change({ follow })} />
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
