/** Fields for the real length of a body and the period of its stroke, which the browser remembers. */

import { useId, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Units } from "../api/types";
import { useFetched } from "../store/fetch";
import { keep, readKept } from "../store/kept";
import { text } from "./text";

/** Quantities as typed, such as `1 mm`; empty where none is given. */
export interface Typed {
  length: string;
  period: string;
}

const STORAGE_KEY = "microcosmos:real-units";
const EMPTY: Typed = { length: "", period: "" };

const remembered = (): Typed => ({ ...EMPTY, ...readKept<Partial<Typed>>(STORAGE_KEY, {}) });

/** A body in lattice units. */
interface Body {
  cells: number;
  /** Steps of a stroke. */
  steps: number;
  viscosity: number;
}

export interface Real {
  typed: Typed;
  change: (next: Typed) => void;
  /** The quantities as the server reads them; null while it has not answered, and where none is given. */
  units: Units | null;
  /** A sentence on what is wrong or missing; null where both are given, or none is. */
  problem: string | null;
}

/** Somebody types on before the server is asked. */
const DEBOUNCE_MS = 200;

/** The typed quantities, and the server's conversion to SI units, for a body too. */
export function useReal(body: Body | null): Real {
  const [typed, setTyped] = useState(remembered);
  const { length, period } = typed;
  const given = Boolean(length || period);
  // A server that cannot be reached tells nothing; the next letter asks again.
  const read = async () => (given ? await api.readUnits({ ...typed, ...body }).catch(() => null) : null);
  const inputs = [length, period, body?.cells, body?.steps, body?.viscosity];
  const { value } = useFetched(read, inputs, DEBOUNCE_MS);
  const units = given ? value : null;
  const change = (next: Typed) => {
    setTyped(next);
    keep(STORAGE_KEY, next);
  };
  return { typed, change, units, problem: problemOf(typed, units) };
}

export function problemOf({ length, period }: Typed, units: Pick<Units, "wrong"> | null): string | null {
  const wrong = units?.wrong ?? [];
  if (length !== "" && wrong.includes("length")) return text.wrongLength;
  if (period !== "" && wrong.includes("period")) return text.wrongPeriod;
  if (length === "" && period !== "") return text.needsLength;
  if (period === "" && length !== "") return text.needsPeriod;
  return null;
}

export function RealFields({ typed, change, units, problem }: Real) {
  const id = useId();
  const field = (name: keyof Typed, title: string, such: string) => (
    <label class="compact">
      {title}
      <input
        size={6}
        value={typed[name]}
        placeholder={such}
        aria-invalid={typed[name] !== "" && units?.wrong.includes(name) === true}
        aria-describedby={problem ? id : undefined}
        onInput={({ currentTarget }) => change({ ...typed, [name]: currentTarget.value })}
      />
    </label>
  );
  return (
    <>
      <div class="row">
        {field("length", text.bodyLength, "1 mm")}
        {field("period", text.strokePeriod, "0.5 s")}
      </div>
      {problem && (
        <p id={id} class="wrong-text small" role="status">
          {problem}
        </p>
      )}
    </>
  );
}
