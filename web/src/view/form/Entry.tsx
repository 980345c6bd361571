/** One value of a spec: its name, its control, what it means, what is wrong with it. */

import type { Json } from "../../api/types";
import { valueAt } from "./document";
import type { Leaf } from "./fields";
import {
  ChoiceInput,
  FlagInput,
  ListInput,
  NestedInput,
  NumberInput,
  SeveralInput,
  TextInput,
} from "./inputs";

export interface FormState {
  document: Json;
  /** What the values were when a preset filled the form. */
  original: Json;
  messages: ReadonlyMap<string, string[]>;
  change: (path: string, value: Json) => void;
}

/** Values that need more room than a number. */
const WIDE = ["list", "several", "nested"];

export function Entry({ field, state }: { field: Leaf; state: FormState }) {
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
    <div class={`entry ${WIDE.includes(field.kind) ? "wide" : ""}`}>
      <label id={`${common.id}-label`} for={field.kind === "several" ? undefined : common.id}>
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
      {field.kind === "list" && <ListInput {...common} field={field} />}
      {field.kind === "several" && <SeveralInput {...common} field={field} />}
      {field.kind === "nested" && <NestedInput {...common} />}
      {field.kind === "flag" && <FlagInput {...common} />}
      {field.kind === "text" && <TextInput {...common} />}
      <div id={`${common.id}-about`} class="about">
        {field.help && <p class="help">{field.help}</p>}
        <Sentences messages={messages} />
      </div>
    </div>
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
