/** The name of a fork, and errors about its initial creatures. */

import type { FieldError } from "../api/types";
import { text } from "./text";

interface Props {
  /** Null where it cannot be given one yet. */
  name: string | null;
  errors: readonly FieldError[];
  onName: (name: string) => void;
}

export function ForkCard({ name, errors, onName }: Props) {
  const wrong = errors.filter(({ field }) => isForkField(field));
  return (
    <section class="card sweep-card" aria-labelledby="fork-title">
      <h2 id="fork-title">{text.fork}</h2>
      <p class="help">{text.forkAbout}</p>
      {name !== null && (
        <div class="sweep-entries">
          <label class="sweep-name-field">
            <span>{text.runName}</span>
            <input
              type="text"
              maxLength={200}
              value={name}
              placeholder={text.optional}
              onInput={(event) => onName(event.currentTarget.value)}
            />
          </label>
        </div>
      )}
      {wrong.map(({ message }) => (
        <p key={message} class="wrong-text small" role="alert">
          {message}
        </p>
      ))}
    </section>
  );
}

/** True for errors of fields that the form does not show. */
export const isForkField = (field: string): boolean =>
  /^(from|name|generation|search\.initial)\b/.test(field);
