/** A fork: a new run that starts from creatures of another one. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { FieldError, ForkRequest } from "../api/types";
import type { Draft, ForkSource } from "../store/draft";
import { Card } from "../ui/Page";
import { Messages } from "./form/Entry";
import { mergePatch, withInitial } from "./initialCreatures";
import type { Alternative } from "./editorState";
import { text } from "./text";

export interface Fork {
  /** Null if the fork is sent as an ordinary run, which has no name yet. */
  name: string | null;
  onName: (name: string) => void;
  /** The request; null if the spec says everything. */
  request: Alternative | null;
}

export function useFork({ base, spec }: Draft): Fork {
  const [name, onName] = useState("");
  useEffect(() => onName(""), [base]);
  const request = useMemo(() => forkRequest({ base, spec }, name), [base, spec, name]);
  return { name: request && name, onName, request };
}

export function forkRequest({ base, spec }: Draft, name: string): Alternative | null {
  const { run = null, at = null } = base.fork ?? {};
  if (run === null) return null;
  // The server ignores initial creatures in the spec of a fork.
  const patch = mergePatch(withInitial(base.spec, []), withInitial(spec, []));
  const then = at === null ? {} : { generation: at };
  return { fork: { run, from: fromOf(base.fork!), ...then, spec: patch, name: name.trim() || null } };
}

function fromOf({ named, cells }: ForkSource): ForkRequest["from"] {
  if (named !== null) return { creatures: named };
  return cells === null ? { archive: true } : { cells };
}

export function ForkCard({ fork, errors }: { fork: Fork; errors: readonly FieldError[] }) {
  const wrong = errors.filter(({ field }) => isForkField(field)).map(({ reason }) => reason);
  return (
    <Card id="fork" kind="sweep-card" title={text.fork}>
      <p class="help">{text.forkAbout}</p>
      {fork.name !== null && (
        <div class="sweep-entries row">
          <NameEntry title={text.runName} value={fork.name} onChange={fork.onName} />
        </div>
      )}
      <Messages messages={wrong} />
    </Card>
  );
}

interface NameProps {
  title: string;
  value: string;
  onChange: (name: string) => void;
}

export function NameEntry({ title, value, onChange }: NameProps) {
  return (
    <label class="sweep-name-field over">
      <span>{title}</span>
      <input
        type="text"
        maxLength={200}
        value={value}
        placeholder={text.optional}
        onInput={(event) => onChange(event.currentTarget.value)}
      />
    </label>
  );
}

/** True for errors of fields that the form does not show. */
export const isForkField = (field: string): boolean =>
  /^(from|name|generation|search\.initial)\b/.test(field);
