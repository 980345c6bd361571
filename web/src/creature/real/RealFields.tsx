/** Fields for the real length of a body and the period of its stroke, which the browser remembers. */

import { useId, useState } from "preact/hooks";
import { lengthOf, periodOf, problemOf, type Typed } from "./quantity";
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

/** What is typed, and a function that changes it. */
export function useTyped(): [typed: Typed, change: (next: Typed) => void] {
  const [typed, setTyped] = useState(remembered);
  const change = (next: Typed) => {
    setTyped(next);
    remember(next);
  };
  return [typed, change];
}

interface Props {
  typed: Typed;
  onChange: (next: Typed) => void;
}

export function RealFields({ typed, onChange }: Props) {
  const id = useId();
  const problem = problemOf(typed);
  const field = (name: keyof Typed, such: string, read: (typed: string) => number | null) => (
    <label class="compact">
      {text[name]}
      <input
        size={6}
        value={typed[name]}
        placeholder={such}
        aria-invalid={typed[name] !== "" && read(typed[name]) === null}
        aria-describedby={problem ? id : undefined}
        onInput={({ currentTarget }) => onChange({ ...typed, [name]: currentTarget.value })}
      />
    </label>
  );
  return (
    <>
      <div class="row">
        {field("length", "1 mm", lengthOf)}
        {field("period", "0.5 s", periodOf)}
      </div>
      {problem && (
        <p id={id} class="wrong-text small" role="status">
          {problem}
        </p>
      )}
    </>
  );
}
