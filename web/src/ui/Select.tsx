/** Inputs for choices: a list, a row of buttons, a checkbox, a slider, a panel below a button. */

import type { ComponentChildren } from "preact";
import { useRef } from "preact/hooks";
import { useListener } from "../store/polling";

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

interface SliderProps {
  title: string;
  min: number;
  max: number;
  step: number;
  value: number;
  /** The text that screen readers say in place of the value. */
  reading?: string;
  onChange: (value: number) => void;
  /** Shown behind the slider. */
  children?: ComponentChildren;
}

export function Slider({ title, reading, onChange, children, ...range }: SliderProps) {
  return (
    <label class="compact">
      {title}
      <input
        type="range"
        {...range}
        aria-valuetext={reading}
        onInput={(event) => onChange(event.currentTarget.valueAsNumber)}
      />
      {children}
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

interface DropdownProps {
  title: string;
  /** A dot says that something in the panel is not as it was at first. */
  changed?: boolean;
  children: ComponentChildren;
}

export function Dropdown({ title, changed = false, children }: DropdownProps) {
  const panel = useRef<HTMLDetailsElement>(null);
  const close = () => panel.current?.removeAttribute("open");
  useListener("pointerdown", ({ target }) => {
    if (!panel.current?.contains(target as Node)) close();
  });
  return (
    <details ref={panel} class="dropdown" onKeyDown={(event) => event.key === "Escape" && close()}>
      <summary class={changed ? "changed" : ""}>{title}</summary>
      <div class="card">{children}</div>
    </details>
  );
}
