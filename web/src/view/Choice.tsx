/** One of several words, which have a title each: from a list, or from a row of buttons. */

interface Props {
  title: string;
  choices: readonly (readonly [name: string, title: string])[];
  value: string;
  onChange: (name: string) => void;
}

export function Choice({ title, choices, value, onChange }: Props) {
  return (
    <label class="compact">
      {title}
      <select value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        {choices.map(([name, words]) => (
          <option key={name} value={name}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

interface SegmentsProps<T extends string> {
  label: string;
  choices: readonly (readonly [name: T, title: string])[];
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
