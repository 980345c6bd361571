/** The physics audit of a creature: start it, wait for it, show its result. */

import * as api from "../api/client";
import type { Audit, AuditRow } from "../api/types";
import { useFetched } from "../store/fetch";
import { usePolled } from "../store/polling";
import { setQuery } from "../store/router";
import { number } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { TrustBadge } from "../ui/TrustBadge";
import { CheckCard } from "./CheckCard";
import { text } from "./text";

/** The address of the card below that of its page. */
export const AUDIT_HASH = "#audit";

export interface AuditState {
  /** The verdict, null without an audit; undefined until it is known. */
  trusted: boolean | null | undefined;
  requested: boolean;
  audit: Audit | null;
  note: string | null;
  error: string | null;
}

/** The audit of a creature: read if there is one, made if the address requests it. */
export function useAudit(sha: string, query: URLSearchParams): AuditState {
  const saved = useFetched(() => api.readVerdict(sha), [sha]).value?.trusted;
  const requested = query.has("audit") || typeof saved === "boolean";
  const polled = usePolled(requested ? () => api.readAudit(sha) : null, [sha, requested]);
  const { value: audit, note, error } = polled;
  return { trusted: audit ? audit.verdict.trusted : saved, requested, audit, note, error };
}

export function AuditCard({ trusted, requested, audit, note, error }: AuditState) {
  return (
    <CheckCard
      {...{ note, error }}
      name="audit"
      title={text.audit}
      verdict={typeof trusted === "boolean" && <TrustBadge trusted={trusted} />}
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
