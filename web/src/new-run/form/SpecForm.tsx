/** A form for a spec, generated from its schema, with an outline of its sections. */

import type { ComponentChildren } from "preact";
import type { Json } from "../../api/types";
import { Term } from "../../ui/Term";
import { Options } from "../../ui/Select";
import { words } from "../../ui/format";
import { countWithin, isOff, isApplicable, partOf, valueAt, withChoice } from "./document";
import type { Field, Rows, Section, Union } from "./fields";
import { type FormState, Entry, EntryName, Errors } from "./Entry";
import { messageOf } from "./partners";
import { text } from "./text";

/** Sections of a form; the first one holds the values outside all others. */
export function partsOf(form: Section): (Section | Union)[] {
  const isSection = (field: Field) => field.kind === "section" || field.kind === "union";
  const others = form.fields.filter((field) => !isSection(field));
  const general: Section = { ...form, title: text.general, help: "", fields: others };
  return [general, ...(form.fields.filter(isSection) as (Section | Union)[])];
}

export function SpecForm({ parts, state }: { parts: (Section | Union)[]; state: FormState }) {
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
  const wrong = part.path !== "" && countWithin(state.errors.keys(), part.path) > 0;
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

/** A section that may be switched off, or one of several kinds. */
function Part({ part, state, kind, open = true, children }: PartProps) {
  const off = part.kind === "section" && isOff(part, state.document);
  const section = part.kind === "union" ? partOf(part, state.document) : part;
  const switchable = part.kind === "section" && part.initial !== undefined;
  return (
    <fieldset class={kind} aria-label={part.title}>
      {!switchable && (
        <legend>
          <Term name={part.title} />
        </legend>
      )}
      {switchable && <PartSwitch {...{ part, off, state }} />}
      {part.help && <p class="help">{part.help}</p>}
      <div hidden={!open} id={kind === "inside" ? `inside-${part.path || "general"}` : undefined}>
        {part.kind === "union" && <KindSelect union={part} state={state} />}
        <Errors errors={state.errors.get(part.path)} />
        {section && !off && <Fields section={section} state={state} />}
        {children}
      </div>
    </fieldset>
  );
}

/** A switch for a section; its first values are those of the preset, or defaults. */
function PartSwitch({ part, off, state }: { part: Section; off: boolean; state: FormState }) {
  const initial = valueAt(state.original, part.path) ?? part.initial!;
  const id = `field-${part.path}`;
  return (
    <div class="entry heading">
      <EntryName path={part.path} title={part.title} state={state} target={id} />
      <input
        id={id}
        type="checkbox"
        class="switch"
        checked={!off}
        onChange={() => state.change(part.path, off ? initial : null)}
      />
    </div>
  );
}

const NONE = ["null", text.none] as const;

interface KindProps {
  union: Union;
  state: FormState;
  /** By default the name of the choice. */
  title?: string;
}

/** The choice between several parts, or none; a newly selected one has its defaults. */
export function KindSelect({ union, state, title }: KindProps) {
  const path = `${union.path}.${union.tag}`;
  const id = `field-${path}`;
  const value = valueAt(state.document, path);
  const original = valueAt(state.original, union.path);
  // Parts with other fields are reset as a whole, parts with the same fields by their name.
  const at = state.changed.has(path) ? path : union.path;
  const note = messageOf(state.note, state.document, union.path);
  const choose = (name: string) => {
    const before = String(valueAt(state.original, path)) === name;
    state.change(union.path, before ? original : (union.parts.get(name)?.initial ?? null));
  };
  const parts = [...union.parts.keys()].map((name) => [name, name] as const);
  return (
    <div class="entry">
      <EntryName path={at} title={title ?? words(union.tag)} state={state} target={id} />
      <select
        id={id}
        value={String(value)}
        aria-describedby={`${id}-about`}
        onChange={(event) => choose(event.currentTarget.value)}
      >
        <Options of={union.nullable ? [NONE, ...parts] : parts} />
      </select>
      <p id={`${id}-about`} class="help about">
        {union.parts.get(String(value))?.help}
      </p>
      {note && (
        <p class="about note small" role="status">
          {note}
        </p>
      )}
    </div>
  );
}

function Fields({ section, state }: { section: Section; state: FormState }) {
  const applicable = section.fields.filter((field) => isApplicable(field, state.document));
  return applicable.map((field) => {
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
      <div class="rows-title">
        <EntryName path={rows.path} title={rows.title} state={state} />
      </div>
      <Errors errors={state.errors.get(rows.path)} />
      {rows.help && <p class="help">{rows.help}</p>}
      {items.map((_, i) => (
        <Part key={`${i} of ${items.length}`} part={rows.row(i)} state={state} kind="form-row">
          {items.length > rows.minItems && (
            <button type="button" class="plain" onClick={() => remove(i)}>
              {text.remove(lower(rows.row(i).title))}
            </button>
          )}
        </Part>
      ))}
      {items.length < rows.maxItems && (
        <button type="button" class="plain" onClick={() => state.change(rows.path, [...items, rows.initial])}>
          {text.addTo(lower(rows.title))}
        </button>
      )}
    </div>
  );
}

const lower = (title: string) => title.charAt(0).toLowerCase() + title.slice(1);

interface Props {
  parts: (Section | Union)[];
  state: FormState;
}

export function Outline({ parts, state }: Props) {
  return (
    <nav class="outline" aria-label={text.sections}>
      {parts.map((part) => {
        const wrong = within(part, state.errors.keys(), parts);
        const changed = within(part, state.changed, parts);
        return (
          <button type="button" key={part.path} class="plain" onClick={() => goToSection(part.path, state)}>
            {part.title}
            {wrong > 0 && <span class="wrong-text">{text.errors(wrong)}</span>}
            {wrong === 0 && changed > 0 && <span class="tally">{text.changed(changed)}</span>}
          </button>
        );
      })}
    </nav>
  );
}

/** Number of paths in a section; paths outside all sections count for the first. */
function within({ path }: Props["parts"][0], paths: Iterable<string>, parts: Props["parts"]): number {
  const all = [...paths];
  if (path) return countWithin(all, path);
  const others = parts.reduce((sum, part) => sum + (part.path ? countWithin(all, part.path) : 0), 0);
  return all.length - others;
}

function goToSection(path: string, state: FormState): void {
  state.close(path, false);
  requestAnimationFrame(() => {
    const section = document.getElementById(`section-${path || "general"}`);
    section?.scrollIntoView({ block: "start" });
    section?.querySelector<HTMLElement>("input, select, textarea")?.focus({ preventScroll: true });
  });
}
