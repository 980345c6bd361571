/** What a fork is called, and what the server says of the creatures that it begins from. */

import type { FieldError } from "../api/types";

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
      <h2 id="fork-title">Fork</h2>
      <p class="help">
        The creatures are evaluated first, as they are, in this spec’s world, body and task; all others come
        of them.
      </p>
      {name !== null && (
        <div class="sweep-entries">
          <label class="sweep-name-field">
            <span>Name of the run</span>
            <input
              type="text"
              maxLength={200}
              value={name}
              placeholder="may be left empty"
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

/** Such complaints are of no field that the form shows. */
export const isForkField = (field: string): boolean => /^(from|name|generation|search\.initial)\b/.test(field);
