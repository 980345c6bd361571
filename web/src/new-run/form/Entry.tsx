/** One field of a spec: name, control, help and errors. */

import type { Json } from "../../api/types";
import { number } from "../../ui/format";
import { valueAt } from "./document";
import type { Leaf, NumberField } from "./fields";
import {
  ChoiceInput,
  FlagInput,
  ListInput,
  NestedInput,
  NumberInput,
  SeveralInput,
  TextInput,
  rangeText,
} from "./inputs";
import { text } from "./text";

export interface FormState {
  document: Json;
  /** The values before any change. */
  original: Json;
  /** Paths of changed values. */
  changed: ReadonlySet<string>;
  messages: ReadonlyMap<string, string[]>;
  change: (path: string, value: Json) => void;
  /** Parts that are shown closed. */
  closed: ReadonlySet<string>;
  close: (path: string, closed: boolean) => void;
}

/** Values that need more room than a number. */
const WIDE = ["list", "several", "nested"];

export function Entry({ field, state }: { field: Leaf; state: FormState }) {
  const value = valueAt(state.document, field.path);
  const messages = state.messages.get(field.path) ?? [];
  const common = {
    id: `field-${field.path}`,
    value,
    invalid: messages.length > 0,
    onChange: (next: Json) => state.change(field.path, next),
  };
  const unit = field.kind === "number" ? unitOf(field, state.document) : "";
  return (
    <div class={`entry ${WIDE.includes(field.kind) ? "wide" : ""}`}>
      <span class="entry-name">
        <label id={`${common.id}-label`} for={field.kind === "several" ? undefined : common.id}>
          {field.title}
        </label>
        <Reset path={field.path} state={state} />
      </span>
      {field.kind === "number" && <NumberInput {...common} field={field} unit={unit} />}
      {field.kind === "choice" && <ChoiceInput {...common} field={field} />}
      {field.kind === "list" && <ListInput {...common} />}
      {field.kind === "several" && <SeveralInput {...common} field={field} />}
      {field.kind === "nested" && <NestedInput {...common} />}
      {field.kind === "flag" && <FlagInput {...common} />}
      {field.kind === "text" && <TextInput {...common} />}
      <div id={`${common.id}-about`} class="about">
        <p class="help">
          {field.help} {aboutPlugin(field, value)} <span class="range">{rangeOf(field, unit)}</span>
        </p>
        <Sentences messages={messages} />
      </div>
    </div>
  );
}

/** Description of a plug-in, and the workers that offer it. */
function aboutPlugin(field: Leaf, value: Json): string {
  const plugin = field.kind === "choice" ? field.plugins?.[String(value)] : undefined;
  return plugin ? text.plugin(String(value), plugin.about, plugin.workers.join(", ")) : "";
}

/** The unit, unless the title already names it. */
function unitOf({ unit, unitBy, title }: NumberField, document: Json): string {
  const found = unitBy ? (unitBy.units[String(valueAt(document, unitBy.path))] ?? "") : unit;
  return found === title.toLowerCase() ? "" : found;
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
  return range && `${range.charAt(0).toUpperCase()}${range.slice(1)} ${unit}`.trimEnd();
}

/** The longest value that the reset button names. */
const NAMED = 12;

/** A button that resets a changed value. */
export function Reset({ path, state }: { path: string; state: FormState }) {
  if (!state.changed.has(path)) return null;
  const value = valueAt(state.original, path);
  const shown = typeof value === "number" ? number(value, 6) : String(value ?? text.auto);
  const short = typeof value !== "object" && shown.length <= NAMED;
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

export function Messages({ path, messages }: { path: string; messages: FormState["messages"] }) {
  return <Sentences messages={messages.get(path) ?? []} />;
}

function Sentences({ messages }: { messages: readonly string[] }) {
  return messages.map((message) => (
    <p key={message} class="wrong-text" role="alert">
      {sentence(message)}
    </p>
  ));
}

function sentence(message: string): string {
  const plain = message.replaceAll("`", "");
  return plain.charAt(0).toUpperCase() + plain.slice(1);
}
