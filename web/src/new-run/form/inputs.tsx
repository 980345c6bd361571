/** The controls of a form, one for each kind of value. */

import { useEffect, useState } from "preact/hooks";
import type { Json } from "../../api/types";
import { count, number } from "../../ui/format";
import { typed, typedJson, typedList } from "./document";
import type { Choice, NumberField, Range, Several } from "./fields";
import { text } from "./text";

interface Common {
  id: string;
  value: Json;
  invalid: boolean;
  onChange: (value: Json) => void;
}

interface NumberProps extends Common {
  field: NumberField;
  unit: string;
}

export function NumberInput({ id, value, invalid, onChange, field, unit }: NumberProps) {
  const [shown, setShown] = useState(() => written(value));
  // Typing "1e" or "0." must not be rewritten; a preset's value must.
  useEffect(() => {
    setShown((now) => (Object.is(typed(now), value) ? now : written(value)));
  }, [value]);
  return (
    <span class="number">
      <input
        id={id}
        inputMode={field.whole ? "numeric" : "decimal"}
        autoComplete="off"
        spellcheck={false}
        value={shown}
        placeholder={field.nullable ? text.auto : ""}
        aria-invalid={invalid}
        aria-describedby={`${id}-about`}
        onInput={(event) => {
          setShown(event.currentTarget.value);
          onChange(typed(event.currentTarget.value));
        }}
      />
      {unit && <span class="unit">{unit}</span>}
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
      {field.nullable && <option value="null">{text.auto}</option>}
      {field.options.map((option) => (
        <option key={String(option)} value={JSON.stringify(option)}>
          {field.plugins?.[String(option)]?.title ?? String(option).replaceAll("_", " ")}
        </option>
      ))}
    </select>
  );
}

/** Several numbers, written in a row. */
export function ListInput({ id, value, invalid, onChange }: Common) {
  const write = (items: Json) => (Array.isArray(items) ? items.join(", ") : "");
  return <Written {...{ id, value, invalid, onChange }} write={write} read={typedList} />;
}

/** Lists within a list, written as JSON. */
export function NestedInput({ id, value, invalid, onChange }: Common) {
  const write = (items: Json) => (typeof items === "string" ? items : JSON.stringify(items));
  return <Written {...{ id, value, invalid, onChange }} write={write} read={typedJson} />;
}

interface WrittenProps extends Common {
  write: (value: Json) => string;
  read: (text: string) => Json;
}

/** A text that stands for a value; what is being typed is not rewritten, a preset's is. */
function Written({ id, value, invalid, onChange, write, read }: WrittenProps) {
  const [text, setText] = useState(() => write(value));
  const same = (a: Json, b: Json) => JSON.stringify(a) === JSON.stringify(b);
  useEffect(() => {
    setText((now) => (same(read(now), value) ? now : write(value)));
  }, [value]);
  return (
    <textarea
      id={id}
      rows={2}
      spellcheck={false}
      value={text}
      aria-invalid={invalid}
      aria-describedby={`${id}-about`}
      onInput={(event) => {
        setText(event.currentTarget.value);
        onChange(read(event.currentTarget.value));
      }}
    />
  );
}

/** A box for each of a few words; the order stays that of the schema. */
export function SeveralInput({ id, value, invalid, onChange, field }: Common & { field: Several }) {
  const chosen = Array.isArray(value) ? value : [];
  const turn = (option: Json, on: boolean) =>
    onChange(field.options.filter((each) => (each === option ? on : chosen.includes(each))));
  return (
    <div class="several" role="group" aria-labelledby={`${id}-label`}>
      {field.options.map((option) => (
        <label key={String(option)}>
          <input
            type="checkbox"
            checked={chosen.includes(option)}
            aria-invalid={invalid}
            onChange={(event) => turn(option, event.currentTarget.checked)}
          />
          {String(option).replaceAll("_", " ")}
        </label>
      ))}
    </div>
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

/** `16 to 2,048`, `more than 0`, or nothing. */
export function rangeText({ low, lowOpen, high, highOpen }: Range): string {
  const parts = [
    low === undefined ? "" : text.low(lowOpen, limit(low)),
    high === undefined ? "" : text.high(highOpen, limit(high)),
  ];
  if (low !== undefined && high !== undefined && !lowOpen && !highOpen) {
    return text.range(limit(low), limit(high));
  }
  return parts.filter(Boolean).join(", ");
}

const limit = (value: number) => (Number.isInteger(value) ? count(value) : number(value, 6));
