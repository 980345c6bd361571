/** The controls of a form, one for each kind of value. */

import { useEffect, useState } from "preact/hooks";
import type { Json } from "../../api/types";
import { typed } from "./document";
import type { Choice, NumberField, Range } from "./fields";

interface Common {
  id: string;
  value: Json;
  invalid: boolean;
  onChange: (value: Json) => void;
}

export function NumberInput({ id, value, invalid, onChange, field }: Common & { field: NumberField }) {
  const [text, setText] = useState(() => written(value));
  // Typing "1e" or "0." must not be rewritten; a preset's value must.
  useEffect(() => {
    setText((now) => (Object.is(typed(now), value) ? now : written(value)));
  }, [value]);
  return (
    <span class="number">
      <input
        id={id}
        inputMode={field.whole ? "numeric" : "decimal"}
        autoComplete="off"
        spellcheck={false}
        value={text}
        placeholder={field.nullable ? "auto" : ""}
        title={rangeText(field.range)}
        aria-invalid={invalid}
        aria-describedby={`${id}-about`}
        onInput={(event) => {
          setText(event.currentTarget.value);
          onChange(typed(event.currentTarget.value));
        }}
      />
      {field.unit && <span class="unit">{field.unit}</span>}
    </span>
  );
}

export function ChoiceInput({ id, value, invalid, onChange, field }: Common & { field: Choice }) {
  return (
    <select
      id={id}
      value={JSON.stringify(value)}
      aria-invalid={invalid}
      aria-describedby={`${id}-about`}
      onChange={(event) => onChange(JSON.parse(event.currentTarget.value))}
    >
      {field.options.map((option) => (
        <option key={String(option)} value={JSON.stringify(option)}>
          {String(option).replaceAll("_", " ")}
        </option>
      ))}
    </select>
  );
}

export function FlagInput({ id, value, invalid, onChange }: Common) {
  return (
    <input
      id={id}
      type="checkbox"
      class="switch"
      checked={value === true}
      aria-invalid={invalid}
      aria-describedby={`${id}-about`}
      onChange={(event) => onChange(event.currentTarget.checked)}
    />
  );
}

export function TextInput({ id, value, invalid, onChange }: Common) {
  return (
    <input
      id={id}
      value={typeof value === "string" ? value : ""}
      aria-invalid={invalid}
      aria-describedby={`${id}-about`}
      onInput={(event) => onChange(event.currentTarget.value)}
    />
  );
}

function written(value: Json): string {
  return value === null ? "" : String(value);
}

function rangeText({ low, lowOpen, high, highOpen }: Range): string {
  const parts = [
    low === undefined ? "" : `${lowOpen ? "more than" : "at least"} ${low}`,
    high === undefined ? "" : `${highOpen ? "less than" : "at most"} ${high}`,
  ];
  return parts.filter(Boolean).join(", ");
}
