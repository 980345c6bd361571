/** A form for a spec, generated from its schema. */

import type { ComponentChildren } from "preact";
import type { Json } from "../../api/types";
import { words } from "../../ui/format";
import { countWithin } from "./changes";
import { isOff, isThere, partOf, valueAt, withChoice } from "./document";
import type { Field, Rows, Section, Union } from "./fields";
import { Entry, type FormState, Messages, Reset } from "./Entry";
import { text } from "./text";

interface Props {
  form: Section;
  state: FormState;
}

/** Sections of a form; values that lie in none come first, together. */
export function partsOf(form: Section): (Section | Union)[] {
  const whole = (field: Field) => field.kind === "section" || field.kind === "union";
  const loose = form.fields.filter((field) => !whole(field));
  const general: Section = { ...form, title: text.general, help: "", fields: loose };
  return [general, ...(form.fields.filter(whole) as (Section | Union)[])];
}

export function SpecForm({ form, state }: Props) {
  const parts = partsOf(form);
  return (
    <div class={`spec-form ${parts.length < 3 ? "few" : ""}`}>
      {parts.map((part) => (
        <Card key={part.path} part={part} state={state} />
      ))}
    </div>
  );
}

/** A section that can be closed; an error opens it. */
function Card({ part, state }: { part: Section | Union; state: FormState }) {
  const wrong = part.path !== "" && countWithin(state.messages.keys(), part.path) > 0;
  const open = wrong || !state.closed.has(part.path);
  const name = part.path || "general";
  return (
    <div class={`card form-section ${open ? "" : "collapsed"}`} id={`section-${name}`}>
      <button
        type="button"
        class="fold"
        aria-expanded={open}
        aria-controls={`inside-${name}`}
        aria-label={text.toggle(open, part.title)}
        onClick={() => state.close(part.path, open)}
      />
      <Part part={part} state={state} kind="inside" open={open} />
    </div>
  );
}

interface PartProps {
  part: Section | Union;
  state: FormState;
  kind: "inside" | "form-row";
  open?: boolean;
  children?: ComponentChildren;
}

/** A section, one that can be switched off, or one of several. */
function Part({ part, state, kind, open = true, children }: PartProps) {
  const off = part.kind === "section" && isOff(part, state.document);
  const section = part.kind === "union" ? partOf(part, state.document) : part;
  const switchable = part.kind === "section" && part.fresh !== undefined;
  return (
    <fieldset class={kind} aria-label={part.title}>
      {!switchable && <legend>{part.title}</legend>}
      {switchable && <Switch {...{ part, off, state }} />}
      {part.help && <p class="help">{part.help}</p>}
      <div hidden={!open} id={kind === "inside" ? `inside-${part.path || "general"}` : undefined}>
        {part.kind === "union" && <Kinds union={part} state={state} />}
        <Messages path={part.path} messages={state.messages} />
        {section && !off && <Fields section={section} state={state} />}
        {children}
      </div>
    </fieldset>
  );
}

/** Turns a section on with its defaults, or with what the preset has there. */
function Switch({ part, off, state }: { part: Section; off: boolean; state: FormState }) {
  const fresh = valueAt(state.original, part.path) ?? part.fresh!;
  return (
    <div class="entry heading">
      <span class="entry-name">
        <label id={`field-${part.path}-label`} for={`field-${part.path}`}>
          {part.title}
        </label>
        <Reset path={part.path} state={state} />
      </span>
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
  // Parts of other fields differ as a whole; of the same, by their word.
  const at = state.changed.has(path) ? path : union.path;
  const choose = (name: string) => {
    const before = valueAt(state.original, path) === name;
    state.change(union.path, before ? original : union.parts.get(name)!.fresh!);
  };
  return (
    <div class="entry">
      <span class="entry-name">
        <label id={`field-${at}-label`} for={`field-${path}`}>
          {words(union.tag)}
        </label>
        <Reset path={at} state={state} />
      </span>
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
  const there = section.fields.filter((field) => isThere(field, state.document));
  return there.map((field) => {
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
      <p class="rows-title entry-name">
        <span id={`field-${rows.path}-label`}>{rows.title}</span>
        <Reset path={rows.path} state={state} />
      </p>
      <Messages path={rows.path} messages={state.messages} />
      {rows.help && <p class="help">{rows.help}</p>}
      {items.map((_, i) => (
        <Part key={`${i} of ${items.length}`} part={rows.row(i)} state={state} kind="form-row">
          {items.length > rows.least && (
            <button type="button" class="plain" onClick={() => remove(i)}>
              {text.remove(lower(rows.row(i).title))}
            </button>
          )}
        </Part>
      ))}
      {items.length < rows.most && (
        <button type="button" class="plain" onClick={() => state.change(rows.path, [...items, rows.fresh])}>
          {text.addTo(lower(rows.title))}
        </button>
      )}
    </div>
  );
}

const lower = (title: string) => title.charAt(0).toLowerCase() + title.slice(1);
