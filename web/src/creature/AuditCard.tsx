/** The physics audit of a creature: start it, wait for it, show its result. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Audit, AuditRow } from "../api/types";
import { poll } from "../store/polling";
import { setQuery } from "../store/router";
import { number } from "../ui/format";
import { text } from "./text";
import "./audit.css";

interface Props {
  sha: string;
  query: URLSearchParams;
}

export function AuditCard({ sha, query }: Props) {
  const asked = query.has("audit");
  const { audit, note, error } = useAudit(sha, asked);
  return (
    <section class="card audit" aria-labelledby="audit-title">
      <div class="card-head">
        <h2 id="audit-title">{text.audit}</h2>
        {audit && <Verdict audit={audit} />}
        <span class="spring" />
        {!asked && <button onClick={() => setQuery({ audit: "" })}>{text.runAudit}</button>}
      </div>
      {!asked && <p class="quiet small">{text.auditAbout}</p>}
      {asked && !audit && !error && (
        <p class="quiet" role="status">
          {note ? text.retrying(note) : text.auditing}
        </p>
      )}
      {error && <p class="banner wrong">{error}</p>}
      {audit && <Figures audit={audit} />}
    </section>
  );
}

interface Shown {
  audit: Audit | null;
  note: string | null;
  error: string | null;
}

/** The audit; requests are repeated until it is ready. */
function useAudit(sha: string, asked: boolean): Shown {
  const [state, setState] = useState<Shown>({ audit: null, note: null, error: null });
  useEffect(() => {
    if (!asked) return;
    const change = (part: Partial<Shown>) => setState((old) => ({ ...old, ...part }));
    return poll(() => api.readAudit(sha), {
      value: (audit) => change({ audit }),
      note: (note) => change({ note }),
      error: (error) => change({ error }),
    });
  }, [sha, asked]);
  return state;
}

function Verdict({ audit }: { audit: Audit }) {
  const { survives } = audit.verdict;
  return (
    <span class={`badge ${survives ? "finished" : text.failed}`}>
      {survives ? text.survives : text.fails}
    </span>
  );
}

function textOf({ verdict: { survives, reasons } }: Audit): string {
  const start = survives ? text.auditPassed : text.auditFailed;
  if (reasons.length === 0) return `${start}.`;
  return text.auditReasons(start, survives, reasons.join("; "));
}

function Figures({ audit }: { audit: Audit }) {
  return (
    <>
      <p class="reasons">{textOf(audit)}</p>
      <div class="scroll">
        <table class="results">
          <thead>
            <tr>
              <th scope="col">{text.figure}</th>
              <th scope="col" class="numeric">
                {text.value}
              </th>
              <th scope="col">{text.limit}</th>
              <th scope="col">
                <span class="unseen">{text.result}</span>
              </th>
            </tr>
          </thead>
          <tbody>
            {audit.rows.map((row) => (
              <Row key={row.name} {...row} />
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}

const SIGNS = { true: ["✓", text.passed], false: ["✕", text.failed], null: ["", ""] } as const;

function Row({ quantity, value, unit, bar, passed, note }: AuditRow) {
  const [sign, word] = SIGNS[`${passed}`];
  return (
    <tr>
      <td class="figure">
        {quantity}
        {passed === false && <span class="small wrong-text">{note}</span>}
      </td>
      <td class="numeric">
        {number(value)} <span class="quiet">{unit}</span>
      </td>
      <td>{typeof bar === "number" ? number(bar) : bar}</td>
      <td>
        <span class={`mark-word ${passed === false ? "wrong" : "right"}`} title={word}>
          <span aria-hidden="true">{sign}</span>
          <span class="unseen">{word}</span>
        </span>
      </td>
    </tr>
  );
}
