/** A form for a spec, generated from its schema. */

import type { ComponentChildren } from "preact";
import type { Json } from "../../api/types";
import { words } from "../format";
import { isOff, partOf, valueAt, withChoice } from "./document";
import type { Field, Rows, Section, Union } from "./fields";
import { Entry, type FormState, Messages } from "./Entry";

interface Props {
  form: Section;
  state: FormState;
}

export function SpecForm({ form, state }: Props) {
  const whole = (field: Field) => field.kind === "section" || field.kind === "union";
  const loose = form.fields.filter((field) => !whole(field));
  const general: Section = { ...form, title: "General", fields: loose };
  const parts = [general, ...form.fields.filter(whole)];
  return (
    <div class={`spec-form ${parts.length < 3 ? "few" : ""}`}>
      {parts.map((part) => (
        <Part key={part.path} part={part as Section | Union} state={state} kind="card form-section" />
      ))}
    </div>
  );
}

interface PartProps {
  part: Section | Union;
  state: FormState;
  kind: "card form-section" | "form-row";
  children?: ComponentChildren;
}

/** A section, one that can be switched off, or one of several. */
function Part({ part, state, kind, children }: PartProps) {
  const off = part.kind === "section" && isOff(part, state.document);
  const section = part.kind === "union" ? partOf(part, state.document) : part;
  const switchable = part.kind === "section" && part.fresh !== undefined;
  return (
    <fieldset class={kind} aria-label={part.title}>
      {!switchable && <legend>{part.title}</legend>}
      {switchable && <Switch {...{ part, off, state }} />}
      {part.help && <p class="help">{part.help}</p>}
      {part.kind === "union" && <Kinds union={part} state={state} />}
      <Messages path={part.path} messages={state.messages} />
      {section && !off && <Fields section={section} state={state} />}
      {children}
    </fieldset>
  );
}

/** Turns a section on with its defaults, or with what the preset has there. */
function Switch({ part, off, state }: { part: Section; off: boolean; state: FormState }) {
  const fresh = valueAt(state.original, part.path) ?? part.fresh!;
  return (
    <div class="entry heading">
      <label for={`field-${part.path}`}>{part.title}</label>
      <input
        id={`field-${part.path}`}
        type="checkbox"
        class="switch"
        checked={!off}
        onChange={() => state.change(part.path, off ? fresh : null)}
      />
    </div>
  );
}

/** Which of several parts; another one begins with its defaults. */
function Kinds({ union, state }: { union: Union; state: FormState }) {
  const path = `${union.path}.${union.tag}`;
  const value = valueAt(state.document, path);
  const original = valueAt(state.original, union.path);
  const choose = (name: string) => {
    const before = valueAt(state.original, path) === name;
    state.change(union.path, before ? original : union.parts.get(name)!.fresh!);
  };
  return (
    <div class="entry">
      <label for={`field-${path}`}>{words(union.tag)}</label>
      <select
        id={`field-${path}`}
        value={String(value)}
        aria-describedby={`field-${path}-about`}
        onChange={(event) => choose(event.currentTarget.value)}
      >
        {[...union.parts.keys()].map((name) => (
          <option key={name} value={name}>
            {name}
          </option>
        ))}
      </select>
      <p id={`field-${path}-about`} class="help about">
        {union.parts.get(String(value))?.help}
      </p>
    </div>
  );
}

function Fields({ section, state }: { section: Section; state: FormState }) {
  return section.fields.map((field) => {
    if (field.kind === "constant") return null;
    if (field.kind === "rows") return <RowList key={field.path} rows={field} state={state} />;
    if (field.kind === "section" || field.kind === "union") {
      return <Part key={field.path} part={field} state={state} kind="form-row" />;
    }
    const change = (_: string, value: Json) =>
      state.change("", withChoice(state.document, section, field, value));
    return <Entry key={field.path} field={field} state={{ ...state, change }} />;
  });
}

function RowList({ rows, state }: { rows: Rows; state: FormState }) {
  const value = valueAt(state.document, rows.path);
  const items = Array.isArray(value) ? value : [];
  const remove = (i: number) => state.change(rows.path, items.toSpliced(i, 1));
  return (
    <div class="form-rows" role="group" aria-label={rows.title}>
      <p class="rows-title">{rows.title}</p>
      <Messages path={rows.path} messages={state.messages} />
      {rows.help && <p class="help">{rows.help}</p>}
      {items.map((_, i) => (
        <Part key={`${i} of ${items.length}`} part={rows.row(i)} state={state} kind="form-row">
          {items.length > rows.least && (
            <button type="button" class="plain" onClick={() => remove(i)}>
              Remove {lower(rows.row(i).title)}
            </button>
          )}
        </Part>
      ))}
      {items.length < rows.most && (
        <button
          type="button"
          class="plain"
          onClick={() => state.change(rows.path, [...items, rows.fresh])}
        >
          Add to {lower(rows.title)}
        </button>
      )}
    </div>
  );
}

const lower = (title: string) => title.charAt(0).toLowerCase() + title.slice(1);
