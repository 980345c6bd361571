/** A form for a spec, generated from its schema. */

import type { Json } from "../../api/types";
import { valueAt } from "./document";
import type { Field, Rows, Section } from "./fields";
import { ChoiceInput, FlagInput, NumberInput, TextInput } from "./inputs";

export interface FormState {
  document: Json;
  /** What the values were when a preset filled the form. */
  original: Json;
  messages: ReadonlyMap<string, string[]>;
  change: (path: string, value: Json) => void;
}

interface Props {
  form: Section;
  state: FormState;
}

export function SpecForm({ form, state }: Props) {
  const loose = form.fields.filter((field) => field.kind !== "section");
  const sections = form.fields.filter((field) => field.kind === "section");
  const general: Section = { ...form, title: "General", help: form.help, fields: loose };
  return (
    <div class="spec-form">
      {[general, ...sections].map((section) => (
        <fieldset key={section.path} class="card form-section">
          <legend>{section.title}</legend>
          {section.help && <p class="help">{section.help}</p>}
          <Messages path={section.path} messages={state.messages} />
          <Fields fields={section.fields} state={state} />
        </fieldset>
      ))}
    </div>
  );
}

function Fields({ fields, state }: { fields: Field[]; state: FormState }) {
  return fields.map((field) => {
    if (field.kind === "constant") return null;
    if (field.kind === "rows") return <RowList key={field.path} rows={field} state={state} />;
    if (field.kind !== "section") return <Entry key={field.path} field={field} state={state} />;
    return (
      <fieldset key={field.path} class="form-row">
        <legend>{field.title}</legend>
        <Messages path={field.path} messages={state.messages} />
        <Fields fields={field.fields} state={state} />
      </fieldset>
    );
  });
}

function RowList({ rows, state }: { rows: Rows; state: FormState }) {
  const value = valueAt(state.document, rows.path);
  const items = Array.isArray(value) ? value : [];
  return (
    <div class="form-rows">
      <Messages path={rows.path} messages={state.messages} />
      {items.map((_, i) => (
        <fieldset key={i} class="form-row">
          <legend>{rows.row(i).title}</legend>
          <Messages path={rows.row(i).path} messages={state.messages} />
          <Fields fields={rows.row(i).fields} state={state} />
          {items.length > rows.least && (
            <button
              type="button"
              class="plain"
              onClick={() => state.change(rows.path, items.toSpliced(i, 1))}
            >
              Remove
            </button>
          )}
        </fieldset>
      ))}
      {items.length < rows.most && (
        <button
          type="button"
          class="plain"
          onClick={() => state.change(rows.path, [...items, rows.fresh])}
        >
          Add
        </button>
      )}
    </div>
  );
}

type Leaf = Exclude<Field, { kind: "section" | "rows" | "constant" }>;

function Entry({ field, state }: { field: Leaf; state: FormState }) {
  const value = valueAt(state.document, field.path);
  const messages = state.messages.get(field.path) ?? [];
  const changed = JSON.stringify(value) !== JSON.stringify(valueAt(state.original, field.path));
  const common = {
    id: `field-${field.path}`,
    value,
    invalid: messages.length > 0,
    onChange: (next: Json) => state.change(field.path, next),
  };
  return (
    <div class={`entry ${messages.length > 0 ? "wrong" : ""}`}>
      <label for={common.id}>
        {field.title}
        {changed && (
          <span class="changed" title="Changed from the preset">
            {" "}
            changed
          </span>
        )}
      </label>
      {field.kind === "number" && <NumberInput {...common} field={field} />}
      {field.kind === "choice" && <ChoiceInput {...common} field={field} />}
      {field.kind === "flag" && <FlagInput {...common} />}
      {field.kind === "text" && <TextInput {...common} />}
      <div id={`${common.id}-about`} class="about">
        {field.help && <p class="help">{field.help}</p>}
        <Messages path={field.path} messages={state.messages} />
      </div>
    </div>
  );
}

function Messages({ path, messages }: { path: string; messages: FormState["messages"] }) {
  return (messages.get(path) ?? []).map((message) => (
    <p key={message} class="wrong-text" role="alert">
      {sentence(message)}
    </p>
  ));
}

function sentence(message: string): string {
  const plain = message.replaceAll("`", "");
  return plain.charAt(0).toUpperCase() + plain.slice(1);
}
