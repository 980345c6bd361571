/** The control of a form field, for each kind of value. */

import { useEffect, useState } from "preact/hooks";
import type { Json } from "../../api/types";
import { Options } from "../../ui/Select";
import { typed, typedJson, typedList } from "./document";
import type { Choice, Leaf, Several } from "./fields";
import { text } from "./text";

interface Props<Kind extends Leaf = Leaf> {
  field: Kind;
  value: Json;
  unit: string;
  onChange: (value: Json) => void;
  id: string;
  "aria-invalid": boolean;
  "aria-describedby": string;
}

export function Input(props: Props) {
  const { field, value, unit: _, onChange, ...attributes } = props;
  if (field.kind === "choice") return <ChoiceInput {...props} field={field} />;
  if (field.kind === "several") return <SeveralInput {...props} field={field} />;
  if (field.kind !== "flag") return <WrittenInput {...props} />;
  return (
    <input
      {...attributes}
      type="checkbox"
      class="switch"
      checked={value === true}
      onChange={(event) => onChange(event.currentTarget.checked)}
    />
  );
}

const words = (option: Json) => String(option).replaceAll("_", " ");

function ChoiceInput({ field, value, unit: _, onChange, ...attributes }: Props<Choice>) {
  const options = field.options.map(
    (option) => [JSON.stringify(option), field.plugins?.[String(option)]?.title ?? words(option)] as const,
  );
  return (
    <select
      {...attributes}
      value={JSON.stringify(value)}
      onChange={(event) => onChange(JSON.parse(event.currentTarget.value))}
    >
      <Options of={field.nullable ? [["null", text.auto], ...options] : options} />
    </select>
  );
}

/** A check box for each option; the selected ones stay in the order of the schema. */
function SeveralInput({ field, value, onChange, id, "aria-invalid": invalid }: Props<Several>) {
  const selected = Array.isArray(value) ? value : [];
  const turn = (option: Json, on: boolean) =>
    onChange(field.options.filter((each) => (each === option ? on : selected.includes(each))));
  return (
    <div class="several row" role="group" aria-labelledby={`${id}-label`}>
      {field.options.map((option) => (
        <label key={String(option)}>
          <input
            type="checkbox"
            checked={selected.includes(option)}
            aria-invalid={invalid}
            onChange={(event) => turn(option, event.currentTarget.checked)}
          />
          {words(option)}
        </label>
      ))}
    </div>
  );
}

interface Format {
  write: (value: Json) => string;
  read: (text: string) => Json;
}

const TEXT: Format = { write: (value) => (typeof value === "string" ? value : ""), read: (text) => text };

/** How values of a kind are written in a text field, and read from it. */
const FORMATS: Partial<Record<Leaf["kind"], Format>> = {
  number: { write: (value) => (value === null ? "" : String(value)), read: typed },
  list: { write: (items) => (Array.isArray(items) ? items.join(", ") : ""), read: typedList },
  nested: {
    write: (items) => (typeof items === "string" ? items : JSON.stringify(items)),
    read: typedJson,
  },
};

const same = (a: Json, b: Json) => JSON.stringify(a) === JSON.stringify(b);

function WrittenInput({ field, value, unit, onChange, ...attributes }: Props) {
  const { write, read } = FORMATS[field.kind] ?? TEXT;
  const [shown, setShown] = useState(() => write(value));
  // Typing "1e" or "0." must not be rewritten; a preset's value must.
  useEffect(() => setShown((now) => (same(read(now), value) ? now : write(value))), [value]);
  const control = {
    ...attributes,
    value: shown,
    spellcheck: false,
    onInput: ({ currentTarget }: { currentTarget: HTMLInputElement | HTMLTextAreaElement }) => {
      setShown(currentTarget.value);
      onChange(read(currentTarget.value));
    },
  };
  if (field.kind === "list" || field.kind === "nested") return <textarea {...control} rows={2} />;
  if (field.kind !== "number") return <input {...control} />;
  return (
    <span class="number">
      <input
        {...control}
        inputMode={field.whole ? "numeric" : "decimal"}
        autoComplete="off"
        placeholder={field.nullable ? text.auto : ""}
      />
      {unit && <span class="unit">{unit}</span>}
    </span>
  );
}
