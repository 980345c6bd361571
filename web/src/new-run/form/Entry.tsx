/** One field of a spec: name, control, help and errors. */

import type { FieldError, Json } from "../../api/types";
import { capitalised, count, number } from "../../ui/format";
import { Term } from "../../ui/Term";
import { valueAt, typed, typedJson, typedList } from "./document";
import type { Leaf, NumberField, Range, Choice, Multiple } from "./fields";
import { mendOf } from "./essentials";
import type { Note } from "./partners";
import { text } from "./text";
import { useEffect, useState } from "preact/hooks";
import { Options } from "../../ui/Select";

export interface FormState {
  document: Json;
  original: Json;
  changed: ReadonlySet<string>;
  errors: ReadonlyMap<string, FieldError[]>;
  /** The last change that the form made by itself. */
  note: Note | null;
  change: (path: string, value: Json) => void;
  closed: ReadonlySet<string>;
  close: (path: string, closed: boolean) => void;
}

const WIDE = ["list", "multiple", "nested"];

export function Entry({ field, state }: { field: Leaf; state: FormState }) {
  const { path, kind, title, help } = field;
  const value = valueAt(state.document, path);
  const errors = state.errors.get(path) ?? [];
  const unit = kind === "number" ? unitOf(field, state.document) : "";
  const id = `field-${path}`;
  const mend = errors.length > 0 ? mendOf(field, value, errors) : null;
  return (
    <div class={`entry ${WIDE.includes(kind) ? "wide" : ""}`}>
      <EntryName {...{ path, title, state }} target={kind === "multiple" ? undefined : id} />
      <Input
        {...{ field, value, unit, id }}
        aria-invalid={errors.length > 0}
        aria-describedby={`${id}-about`}
        onChange={(next) => state.change(path, next)}
      />
      <div id={`${id}-about`} class="about">
        <p class="help">
          {help} {aboutPlugin(field, value)} <span class="range">{rangeOf(field, unit)}</span>
        </p>
        <Errors errors={errors} />
        {mend !== null && (
          <button type="button" class="link small" onClick={() => state.change(path, mend)}>
            {text.setTo(number(mend, 6))}
          </button>
        )}
      </div>
    </div>
  );
}

interface NameProps {
  /** Path of the value that the button resets. */
  path: string;
  title: string;
  state: FormState;
  target?: string;
}

export function EntryName({ path, title, state, target }: NameProps) {
  const Label = target ? "label" : "span";
  return (
    <span class="entry-name">
      <Label id={`field-${path}-label`} for={target}>
        <Term name={title} />
      </Label>
      {state.changed.has(path) && <Reset path={path} state={state} />}
    </span>
  );
}

/** The longest value that the reset button names. */
const MAX_LENGTH = 12;

function Reset({ path, state }: { path: string; state: FormState }) {
  const value = valueAt(state.original, path);
  const shown = typeof value === "number" ? number(value, 6) : String(value ?? text.auto);
  const short = typeof value !== "object" && shown.length <= MAX_LENGTH;
  return (
    <button
      type="button"
      class="reset"
      aria-describedby={`field-${path}-label`}
      onClick={() => state.change(path, value)}
    >
      {short ? text.resetTo(shown) : text.undoChange}
    </button>
  );
}

function aboutPlugin(field: Leaf, value: Json): string {
  const plugin = field.kind === "choice" ? field.plugins?.[String(value)] : undefined;
  return plugin ? text.plugin(String(value), plugin.about, plugin.workers.join(", ")) : "";
}

/** The unit, unless the title already names it. */
function unitOf({ unit, unitBy, title }: NumberField, document: Json): string {
  const name = unitBy ? (unitBy.units[String(valueAt(document, unitBy.path))] ?? "") : unit;
  return name === title.toLowerCase() ? "" : name;
}

function rangeOf(field: Leaf, unit: string): string {
  if (field.kind === "list") {
    const range = rangeText(field.item.range);
    return [range && text.each(range), field.item.unit].filter(Boolean).join(" ");
  }
  if (field.kind !== "number") return "";
  // Very large limits exist for safety only and are not shown.
  const { low = 0, high = 0 } = field.range;
  if (Math.max(Math.abs(low), Math.abs(high)) >= 1e9) return "";
  const range = rangeText(field.range);
  return range && capitalised(`${range} ${unit}`.trimEnd());
}

/** `16 to 2,048`, `more than 0`, or nothing. */
export function rangeText({ low, lowOpen, high, highOpen }: Range): string {
  const limit = (value: number) => (Number.isInteger(value) ? count(value) : number(value, 6));
  if (low !== undefined && high !== undefined && !lowOpen && !highOpen) {
    return text.range(limit(low), limit(high));
  }
  const parts = [
    low === undefined ? "" : text.low(lowOpen, limit(low)),
    high === undefined ? "" : text.high(highOpen, limit(high)),
  ];
  return parts.filter(Boolean).join(", ");
}

export const Errors = ({ errors = [] }: { errors?: readonly FieldError[] }) => (
  <Messages messages={errors.map(({ reason }) => reason)} />
);

export function Messages({ messages = [] }: { messages?: readonly (string | null)[] }) {
  return [...new Set(messages.filter((message) => message !== null))].map((message) => (
    <p key={message} class="wrong-text small" role="alert">
      {capitalised(message.replaceAll("`", ""))}
    </p>
  ));
}

interface InputProps<Kind extends Leaf = Leaf> {
  field: Kind;
  value: Json;
  unit: string;
  onChange: (value: Json) => void;
  id: string;
  "aria-invalid": boolean;
  "aria-describedby": string;
}

export function Input(props: InputProps) {
  const { field, value, unit: _, onChange, ...attributes } = props;
  if (field.kind === "choice") return <ChoiceInput {...props} field={field} />;
  if (field.kind === "multiple") return <MultipleInput {...props} field={field} />;
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

function ChoiceInput({ field, value, unit: _, onChange, ...attributes }: InputProps<Choice>) {
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
function MultipleInput({ field, value, onChange, id, "aria-invalid": invalid }: InputProps<Multiple>) {
  const selected = Array.isArray(value) ? value : [];
  const toggle = (option: Json, on: boolean) =>
    onChange(field.options.filter((each) => (each === option ? on : selected.includes(each))));
  return (
    <div class="multiple row" role="group" aria-labelledby={`${id}-label`}>
      {field.options.map((option) => (
        <label key={String(option)}>
          <input
            type="checkbox"
            checked={selected.includes(option)}
            aria-invalid={invalid}
            onChange={(event) => toggle(option, event.currentTarget.checked)}
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

const FORMATS: Partial<Record<Leaf["kind"], Format>> = {
  number: { write: (value) => (value === null ? "" : String(value)), read: typed },
  list: { write: (items) => (Array.isArray(items) ? items.join(", ") : ""), read: typedList },
  nested: {
    write: (items) => (typeof items === "string" ? items : JSON.stringify(items)),
    read: typedJson,
  },
};

const same = (a: Json, b: Json) => JSON.stringify(a) === JSON.stringify(b);

function WrittenInput({ field, value, unit, onChange, ...attributes }: InputProps) {
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
