/** Controls of a replay, and the legend of its field. */

import { ColourBar } from "../ui/ColourBar";
import { css } from "../ui/colours";
import { number } from "../ui/format";
import type { Field, FieldName } from "./fields";
import { type ReplayView, SPEEDS } from "./look";
import { text } from "./text";

export function Speed({ value, onChange }: { value: number; onChange: (speed: number) => void }) {
  return (
    <label class="compact">
      {text.speed}
      <select value={String(value)} onChange={(event) => onChange(Number(event.currentTarget.value))}>
        {SPEEDS.map((speed) => (
          <option key={speed} value={String(speed)}>
            {speed} ×
          </option>
        ))}
      </select>
    </label>
  );
}

const TITLES: Record<FieldName, string> = {
  vorticity: text.vorticity,
  speed: text.speed,
  energy: text.energy,
  none: text.none,
};

interface Props {
  names: FieldName[];
  name: FieldName;
  look: ReplayView;
  change: (part: Partial<ReplayView>) => void;
  /** True if the replay has the flow that tracers follow. */
  flows: boolean;
}

export function LookChoice({ names, name, look, change, flows }: Props) {
  return (
    <div class="view-options">
      {names.length > 1 && (
        <div class="tabs" role="group" aria-label={text.field}>
          {names.map((each) => (
            <button
              key={each}
              type="button"
              aria-pressed={each === name}
              onClick={() => change({ field: each })}
            >
              {TITLES[each]}
            </button>
          ))}
        </div>
      )}
      {flows && names.includes("speed") && (
        <Check label={text.tracers} checked={look.tracers} onChange={(tracers) => change({ tracers })} />
      )}
      <Check label={text.follow} checked={look.follow} onChange={(follow) => change({ follow })} />
    </div>
  );
}

interface CheckProps {
  label: string;
  checked: boolean;
  onChange: (checked: boolean) => void;
}

function Check({ label, checked, onChange }: CheckProps) {
  return (
    <label class="compact">
      <input type="checkbox" checked={checked} onChange={(event) => onChange(event.currentTarget.checked)} />
      {label}
    </label>
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
