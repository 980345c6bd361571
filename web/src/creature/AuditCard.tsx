/** The physics audit of a creature: start it, wait for it, show its result. */

import * as api from "../api/client";
import type { Audit, AuditRow } from "../api/types";
import { useRefusal } from "../store/principal";
import { number } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { TrustBadge } from "../ui/TrustBadge";
import { type Check, useCheck, CheckCard } from "./CheckCard";
import { Mark } from "./Mark";
import { text } from "./text";

/** The address of the card below that of its page. */
export const AUDIT_HASH = "#audit";

export interface AuditState {
  /** The verdict, null without an audit; undefined until it is known. */
  trusted: boolean | null | undefined;
  check: Check<Audit>;
}

/** The audit of a creature, and its verdict. */
export function useAudit(sha: string): AuditState {
  const check = useCheck(sha, api.readAudit, api.orderAudit);
  const { result, never, running, error } = check;
  const none = never || running || error !== null ? null : undefined;
  return { trusted: result ? result.verdict.trusted : none, check };
}

export function AuditCard({ trusted, check }: AuditState) {
  const { result: audit, never, running, note, error, start } = check;
  const mayStart = !useRefusal() && (never || error !== null);
  return (
    <CheckCard
      {...{ note, error }}
      name="audit"
      title={text.audit}
      verdict={typeof trusted === "boolean" && <TrustBadge trusted={trusted} />}
      button={mayStart ? text.runAudit : null}
      onStart={() => void start()}
      running={running ? text.auditing : null}
    >
      {never && <p class="quiet small">{text.auditAbout}</p>}
      {audit && (
        <>
          <p class="reasons">{text.auditVerdict(audit.verdict.trusted, audit.verdict.reasons.join("; "))}</p>
          <Table label={text.auditFigures} columns={COLUMNS} rows={audit.rows} keyOf={({ name }) => name} />
        </>
      )}
    </CheckCard>
  );
}

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
    cell: ({ passed }) => passed !== null && <Mark good={passed} word={passed ? text.passed : text.failed} />,
  },
];
