/** Create, list and revoke tokens; for admins. */

import { useState } from "preact/hooks";
import { createToken, readTokens, revokeToken } from "../api/client";
import type { Token, CreatedToken, TokenScope } from "../api/types";
import { useFetched } from "../store/fetch";
import { orShowError, showToast } from "../store/toasts";
import { ConfirmButton } from "../ui/ConfirmButton";
import { Card } from "../ui/Page";
import { Select } from "../ui/Select";
import { type Column, Table } from "../ui/Table";
import { copyText } from "../ui/clipboard";
import { inDays, number } from "../ui/format";
import { useSubmit } from "../ui/forms";
import { text } from "./text";

export function Tokens({ own }: { own: string | null }) {
  const [version, setVersion] = useState(0);
  const [made, setMade] = useState<CreatedToken | null>(null);
  const { value, error } = useFetched(readTokens, [version]);
  const reload = () => setVersion((count) => count + 1);
  return (
    <Card id="tokens" title={text.tokens}>
      <NewToken
        onMade={(token) => {
          setMade(token);
          reload();
        }}
      />
      {made && <Secret made={made} onDone={() => setMade(null)} />}
      {error && <p class="banner wrong">{error}</p>}
      {value?.length === 0 && <p class="quiet">{text.noTokens}</p>}
      {value && value.length > 0 && <TokenTable tokens={value} own={own} onRevoked={reload} />}
    </Card>
  );
}

const LIMITS = ["max_running", "max_queued", "device_hours"] as const;
type Limits = Partial<Record<(typeof LIMITS)[number], number>>;

/** The limits on the runs of a token, and what they have used. */
export function limitsOf({ max_running, max_queued, device_hours, used_hours }: Token): string {
  return [
    max_running != null && text.atATime(max_running),
    max_queued != null && text.queuedAtMost(max_queued),
    text.hoursUsed(number(used_hours, 2), device_hours ?? null),
  ]
    .filter((part) => part !== false)
    .join(", ");
}

function NewToken({ onMade }: { onMade: (made: CreatedToken) => void }) {
  const [name, setName] = useState("");
  const [scope, setScope] = useState<TokenScope>("read");
  const [days, setDays] = useState("90");
  const [limits, setLimits] = useState<Limits>({});
  const { busy, error, onSubmit } = useSubmit(async () => {
    const quota = Object.fromEntries(LIMITS.map((limit) => [limit, limits[limit] ?? null]));
    onMade(await createToken({ name: name.trim(), scope, expires_at: endOf(Number(days)), ...quota }));
    setName("");
    setLimits({});
  });
  return (
    <form class="new-token row" onSubmit={onSubmit}>
      <label class="over">
        {text.owner}
        <input
          value={name}
          required
          maxLength={64}
          autocomplete="off"
          placeholder={text.ownerHint}
          onInput={({ currentTarget }) => setName(currentTarget.value)}
        />
      </label>
      <Select
        title={text.scope}
        choices={text.scopes}
        value={scope}
        onChange={(name) => setScope(name as TokenScope)}
      />
      <Select title={text.validFor} choices={text.terms} value={days} onChange={setDays} />
      <LimitFields limits={limits} onChange={setLimits} />
      <button class="primary" disabled={busy || !name.trim()}>
        {text.create}
      </button>
      {error && (
        <p class="wrong-text" role="alert">
          {error}
        </p>
      )}
    </form>
  );
}

function LimitFields({ limits, onChange }: { limits: Limits; onChange: (limits: Limits) => void }) {
  return (
    <>
      {LIMITS.map((limit) => (
        <label key={limit} class="over" title={text.limitsHint}>
          {text.limitNames[limit]}
          <input
            type="number"
            min={0}
            step={limit === "device_hours" ? "any" : 1}
            value={limits[limit] ?? ""}
            onInput={({ currentTarget: { value, valueAsNumber } }) =>
              onChange({ ...limits, [limit]: value === "" ? undefined : valueAsNumber })
            }
          />
        </label>
      ))}
    </>
  );
}

/** The secret of a new token, which is shown once. */
function Secret({ made, onDone }: { made: CreatedToken; onDone: () => void }) {
  return (
    <div class="banner secret" role="status">
      <p>
        {text.secretOf}
        <strong>{made.name}</strong>
        {text.secretHint}
      </p>
      <code tabIndex={0}>{made.secret}</code>
      <span class="actions">
        <button onClick={() => copyText(made.secret, text.copied)}>{text.copy}</button>
        <button class="plain" onClick={onDone}>
          {text.done}
        </button>
      </span>
    </div>
  );
}

interface TableProps {
  tokens: Token[];
  own: string | null;
  onRevoked: () => void;
}

function TokenTable({ tokens, own, onRevoked }: TableProps) {
  const columns: Column<Token>[] = [
    { title: text.owner, cell: ({ id, name }) => (id === own ? `${name} ${text.you}` : name) },
    { title: text.prefix, cell: ({ prefix }) => <code>{prefix}…</code> },
    { title: text.scope, cell: ({ scope }) => scope },
    { title: text.created, cell: ({ created_at }) => day(created_at) },
    { title: text.lastUsed, cell: ({ last_used_at }) => (last_used_at ? day(last_used_at) : text.never) },
    { title: text.valid, cell: (token) => tokenStatus(token) },
    { title: text.limits, cell: (token) => limitsOf(token) },
    {
      title: text.revoke,
      unseen: true,
      cell: (token) =>
        !isExpired(token) && (
          <ConfirmButton verb={text.revoke} what={token.name} onConfirm={() => revoke(token, onRevoked)} />
        ),
    },
  ];
  return (
    <Table
      label={text.tokenTable}
      columns={columns}
      rows={tokens}
      keyOf={({ id }) => id}
      rowKind={(token) => (isExpired(token) ? "quiet" : "")}
    />
  );
}

async function revoke({ id, name }: Token, onRevoked: () => void): Promise<void> {
  if ((await orShowError(revokeToken(id))) === null) return;
  showToast({ kind: "note", text: text.revoked(name) });
  onRevoked();
}

export const day = (iso: string) =>
  new Date(iso).toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });

export function tokenStatus(token: Token, now = Date.now()): string {
  const { revoked_at, expires_at } = token;
  if (expires_at && Date.parse(expires_at) <= now) return text.expired(day(expires_at));
  if (revoked_at) return text.revokedOn(day(revoked_at));
  return expires_at ? text.until(day(expires_at)) : text.noExpiry;
}

export const isExpired = (token: Token, now = Date.now()) =>
  token.revoked_at !== null || (token.expires_at !== null && Date.parse(token.expires_at) <= now);

export const endOf = (days: number, now = Date.now()) => (days > 0 ? inDays(days, now) : null);
