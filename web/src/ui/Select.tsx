/** Inputs for choices: a list, a row of buttons, a checkbox. */

type OptionList<T extends string = string> = readonly (readonly [name: T, title: string])[];

interface Props {
  title: string;
  choices: OptionList;
  value: string;
  onChange: (name: string) => void;
}

export function Select({ title, choices, value, onChange }: Props) {
  return (
    <label class="compact">
      {title}
      <select value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        <Options of={choices} />
      </select>
    </label>
  );
}

export const Options = ({ of }: { of: OptionList }) => (
  <>
    {of.map(([name, words]) => (
      <option key={name} value={name}>
        {words}
      </option>
    ))}
  </>
);

interface CheckProps {
  title: string;
  on: boolean;
  onChange: (on: boolean) => void;
}

export function Check({ title, on, onChange }: CheckProps) {
  return (
    <label class="compact">
      <input type="checkbox" checked={on} onChange={(event) => onChange(event.currentTarget.checked)} />
      {title}
    </label>
  );
}

interface SegmentsProps<T extends string> {
  label: string;
  choices: OptionList<T>;
  value: T;
  onSelect: (name: T) => void;
}

export function Segments<T extends string>({ label, choices, value, onSelect }: SegmentsProps<T>) {
  return (
    <div class="choices" role="group" aria-label={label}>
      {choices.map(([name, title]) => (
        <button key={name} type="button" aria-pressed={name === value} onClick={() => onSelect(name)}>
          {title}
        </button>
      ))}
    </div>
  );
}
