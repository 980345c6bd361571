/** The physics audit of a creature: start it, wait for it, show its result. */

import * as api from "../api/client";
import type { Audit, AuditRow } from "../api/types";
import { usePolled } from "../store/polling";
import { setQuery } from "../store/router";
import { number } from "../ui/format";
import { CheckCard } from "./CheckCard";
import { text } from "./text";
import "./audit.css";

interface Props {
  sha: string;
  query: URLSearchParams;
}

export function AuditCard({ sha, query }: Props) {
  const requested = query.has("audit");
  const {
    value: audit,
    note,
    error,
  } = usePolled(requested ? () => api.readAudit(sha) : null, [sha, requested]);
  return (
    <CheckCard
      {...{ note, error }}
      name="audit"
      title={text.audit}
      verdict={audit && (audit.verdict.survives ? ["finished", text.survives] : ["failed", text.fails])}
      button={requested ? null : text.runAudit}
      onStart={() => setQuery({ audit: "" })}
      running={requested && !audit ? text.auditing : null}
    >
      {!requested && <p class="quiet small">{text.auditAbout}</p>}
      {audit && <Figures audit={audit} />}
    </CheckCard>
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
