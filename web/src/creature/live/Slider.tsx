/** A slider with its value in its title. */

import { number } from "../../ui/format";

interface Props {
  title: string;
  range: readonly [low: number, high: number];
  step: number;
  value: number;
  /** The value that screen readers say. */
  shown: number;
  onChange: (value: number) => void;
}

export function Slider({ title, range: [min, max], step, value, shown, onChange }: Props) {
  return (
    <label class="row">
      {title}
      <input
        {...{ type: "range", min, max, step, value }}
        aria-valuetext={number(shown, 2)}
        onInput={({ currentTarget }) => onChange(currentTarget.valueAsNumber)}
      />
    </label>
  );
}
