/** A choice between named options: a list, or a row of buttons. */

type Option<T extends string = string> = readonly (readonly [name: T, title: string])[];

interface Props {
  title: string;
  choices: Option;
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

/** The options of a list. */
export const Options = ({ of }: { of: Option }) => (
  <>
    {of.map(([name, words]) => (
      <option key={name} value={name}>
        {words}
      </option>
    ))}
  </>
);

interface SegmentsProps<T extends string> {
  label: string;
  choices: Option<T>;
  value: T;
  onChoose: (name: T) => void;
}

export function Segments<T extends string>({ label, choices, value, onChoose }: SegmentsProps<T>) {
  return (
    <div class="choices" role="group" aria-label={label}>
      {choices.map(([name, title]) => (
        <button key={name} type="button" aria-pressed={name === value} onClick={() => onChoose(name)}>
          {title}
        </button>
      ))}
    </div>
  );
}
