/** The physics audit of a creature: start it, wait for it, show its result. */

import * as api from "../api/client";
import type { AuditRow } from "../api/types";
import { usePolled } from "../store/polling";
import { setQuery } from "../store/router";
import { number } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { CheckCard } from "./CheckCard";
import { text } from "./text";

export function AuditCard({ sha, query }: { sha: string; query: URLSearchParams }) {
  const requested = query.has("audit");
  const polled = usePolled(requested ? () => api.readAudit(sha) : null, [sha, requested]);
  const { value: audit, note, error } = polled;
  return (
    <CheckCard
      {...{ note, error }}
      name="audit"
      title={text.audit}
      verdict={audit && (audit.verdict.trusted ? ["finished", text.trusted] : ["failed", text.notTrusted])}
      button={requested ? null : text.runAudit}
      onStart={() => setQuery({ audit: "" })}
      running={requested && !audit ? text.auditing : null}
    >
      {!requested && <p class="quiet small">{text.auditAbout}</p>}
      {audit && (
        <>
          <p class="reasons">{text.auditVerdict(audit.verdict.trusted, audit.verdict.reasons.join("; "))}</p>
          <Table label={text.auditFigures} columns={COLUMNS} rows={audit.rows} keyOf={({ name }) => name} />
        </>
      )}
    </CheckCard>
  );
}

const SIGNS = { true: ["✓", text.passed], false: ["✕", text.failed], null: ["", ""] } as const;

const COLUMNS: Column<AuditRow>[] = [
  {
    title: text.figure,
    cell: ({ quantity, passed, note }) => (
      <>
        {quantity}
        {passed === false && <span class="small wrong-text">{note}</span>}
      </>
    ),
  },
  {
    title: text.value,
    cell: ({ value, unit }) => (
      <>
        {number(value)} <span class="quiet">{unit}</span>
      </>
    ),
  },
  { title: text.limit, cell: ({ bar }) => (typeof bar === "number" ? number(bar) : bar) },
  {
    title: text.result,
    unseen: true,
    cell: ({ passed }) => {
      const [sign, word] = SIGNS[`${passed}`];
      return (
        <span class={`mark-word ${passed === false ? "wrong" : "right"}`} title={word}>
          <span aria-hidden="true">{sign}</span>
          <span class="unseen">{word}</span>
        </span>
      );
    },
  },
];
