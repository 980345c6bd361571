/** What is chosen about a replay, and what its colours mean. */

import { ColourBar } from "../ui/ColourBar";
import { css } from "../ui/colours";
import { number } from "../ui/format";
import type { Field, FieldName } from "./fields";
import { type ReplayView, SPEEDS } from "./look";

export function Speed({ value, onChange }: { value: number; onChange: (speed: number) => void }) {
  return (
    <label class="compact">
      Speed
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
  vorticity: "Vorticity",
  speed: "Speed",
  energy: "Energy",
  none: "None",
};

interface Props {
  names: FieldName[];
  name: FieldName;
  look: ReplayView;
  change: (part: Partial<ReplayView>) => void;
  /** Whether the flow is known that tracers follow. */
  flows: boolean;
}

export function LookChoice({ names, name, look, change, flows }: Props) {
  return (
    <div class="view-options">
      {names.length > 1 && (
        <div class="tabs" role="group" aria-label="Field shown">
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
        <Check label="Tracers" checked={look.tracers} onChange={(tracers) => change({ tracers })} />
      )}
      <Check label="Follow" checked={look.follow} onChange={(follow) => change({ follow })} />
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
      label={`${title} from ${numbers[0]} to ${numbers[2]} ${unit}`}
      colourAt={(share) => css(colour(share))}
      numbers={numbers}
    />
  );
}
