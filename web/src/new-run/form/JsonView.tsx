/** A spec as JSON, which can be edited or replaced. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { FieldError, Spec } from "../../api/types";
import { text } from "./text";

interface Props {
  spec: Spec;
  errors: FieldError[];
  /** Use the written text; return its error, or null. */
  onText: (text: string) => string | null;
  /** Called with the error of the text, or null. */
  onProblem: (problem: string | null) => void;
  /** True if all text is selected at first, so that pasting replaces it. */
  replace: boolean;
}

export function JsonView({ spec, errors, onText, onProblem, replace }: Props) {
  const area = useRef<HTMLTextAreaElement>(null);
  const typed = useRef<string | null>(null);
  const [json, setJson] = useState(() => written(spec));
  const [problem, setProblem] = useState<string | null>(null);
  const report = (error: string | null) => {
    setProblem(error);
    onProblem(error);
  };
  useEffect(() => {
    // Changes from outside rewrite the text; its typed changes do not.
    const typing = typed.current !== null;
    typed.current = null;
    if (typing) return;
    setJson(written(spec));
    report(null);
  }, [spec]);
  useEffect(() => {
    if (replace) area.current!.select();
    return () => onProblem(null);
  }, []);
  return (
    <section class="card json-view">
      <label for="spec-json">{text.json}</label>
      <p id="spec-json-about" class="help">
        {text.jsonAbout}
      </p>
      <textarea
        id="spec-json"
        ref={area}
        spellcheck={false}
        autoComplete="off"
        rows={28}
        value={json}
        aria-invalid={problem !== null || errors.length > 0}
        aria-describedby="spec-json-about spec-json-problems"
        onInput={(event) => {
          typed.current = event.currentTarget.value;
          setJson(typed.current);
          const error = onText(typed.current);
          if (error) typed.current = null;
          report(error);
        }}
      />
      <Problems problem={problem} errors={errors} />
    </section>
  );
}

function Problems({ problem, errors }: { problem: string | null; errors: FieldError[] }) {
  return (
    <div id="spec-json-problems" role="status">
      {problem && <p class="wrong-text">{problem}</p>}
      {errors.map(({ field, reason }) => (
        <p key={`${field} ${reason}`} class="wrong-text">
          <code>{field}</code>: {reason.replaceAll("`", "")}
        </p>
      ))}
    </div>
  );
}

const written = (spec: Spec) => JSON.stringify(spec, null, 2);
