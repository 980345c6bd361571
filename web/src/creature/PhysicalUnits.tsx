/** A creature in physical units, once its real length and the period of its stroke are given. */

import { useState } from "preact/hooks";
import type { Creature } from "../api/types";
import { usePoseStream } from "../store/poses";
import { type Typed, lengthOf, periodOf, physicalRows, strokeOf } from "./physical";
import { text } from "./text";

const STORAGE_KEY = "microcosmos:real-units";
const EMPTY: Typed = { length: "", period: "" };

function remembered(): Typed {
  try {
    return { ...EMPTY, ...JSON.parse(localStorage.getItem(STORAGE_KEY) ?? "{}") };
  } catch {
    return EMPTY; // Storage is blocked, or another program wrote it.
  }
}

function remember(typed: Typed): void {
  try {
    localStorage.setItem(STORAGE_KEY, JSON.stringify(typed));
  } catch {
    // Storage is blocked or full: the values last as long as the page.
  }
}

export function PhysicalUnits({ creature }: { creature: Creature }) {
  const [typed, setTyped] = useState(remembered);
  const { stream } = usePoseStream(creature.sha256);
  const steps = strokeOf(creature);
  if (steps === null || !stream) return null;
  const change = (name: keyof Typed) => (event: { currentTarget: HTMLInputElement }) => {
    const next = { ...typed, [name]: event.currentTarget.value };
    setTyped(next);
    remember(next);
  };
  const [length, period] = [lengthOf(typed.length), periodOf(typed.period)];
  const field = (name: keyof Typed, title: string, such: string, value: number | null) => (
    <label class="compact">
      {title}
      <input
        size={6}
        value={typed[name]}
        placeholder={such}
        aria-invalid={typed[name] !== "" && value === null}
        onInput={change(name)}
      />
    </label>
  );
  return (
    <div class="physical">
      <h3>{text.physical}</h3>
      <div class="row">
        {field("length", text.realLength, "1 mm", length)}
        {field("period", text.realPeriod, "0.5 s", period)}
      </div>
      {length !== null && period !== null ? (
        <dl class="rows">
          {physicalRows(creature, { length, period }, stream.header.length, steps).map(([name, value]) => (
            <div key={name}>
              <dt>{name}</dt>
              <dd>{value}</dd>
            </div>
          ))}
        </dl>
      ) : (
        <p class="quiet small">{text.physicalHint}</p>
      )}
    </div>
  );
}
