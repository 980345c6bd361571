/** Create, list and revoke tokens; for admins. */

import { useState } from "preact/hooks";
import { createToken, readTokens, revokeToken } from "../api/client";
import { messageOf } from "../api/problem";
import type { Token, CreatedToken, TokenScope } from "../api/types";
import { useFetched } from "../store/fetch";
import { showError, showToast } from "../store/toasts";
import { ConfirmButton } from "../ui/ConfirmButton";
import { Select } from "../ui/Select";
import { copyText } from "../ui/clipboard";
import { TERMS, day, endOf, isExpired, tokenStatus } from "./tokenText";
import { text } from "./text";

export function Tokens({ own }: { own: string | null }) {
  const [turn, setTurn] = useState(0);
  const [made, setMade] = useState<CreatedToken | null>(null);
  const { value, error } = useFetched(readTokens, [turn]);
  const again = () => setTurn((count) => count + 1);
  return (
    <section class="card" aria-labelledby="tokens-title">
      <h2 id="tokens-title">{text.tokens}</h2>
      <NewToken
        onMade={(token) => {
          setMade(token);
          again();
        }}
      />
      {made && <Secret made={made} onDone={() => setMade(null)} />}
      {error && <p class="banner wrong">{error}</p>}
      {value?.length === 0 && <p class="quiet">{text.noTokens}</p>}
      {value && value.length > 0 && <Table tokens={value} own={own} onRevoked={again} />}
    </section>
  );
}

function NewToken({ onMade }: { onMade: (made: CreatedToken) => void }) {
  const [name, setName] = useState("");
  const [scope, setScope] = useState<TokenScope>("write");
  const [days, setDays] = useState("90");
  const [error, setError] = useState<string | null>(null);
  const submit = async (event: Event) => {
    event.preventDefault();
    try {
      onMade(await createToken({ name: name.trim(), scope, expires_at: endOf(Number(days)) }));
      setName("");
      setError(null);
    } catch (problem) {
      setError(messageOf(problem));
    }
  };
  return (
    <form class="new-token" onSubmit={submit}>
      <label>
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
        choices={SCOPES}
        value={scope}
        onChange={(name) => setScope(name as TokenScope)}
      />
      <Select title={text.validFor} choices={LIFETIMES} value={days} onChange={setDays} />
      <button class="primary" disabled={!name.trim()}>
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

const SCOPES = [
  ["read", text.readOnly],
  ["write", text.readAndWrite],
  ["admin", text.admin],
] as const;
const LIFETIMES = TERMS.map(([title, days]) => [String(days), title.toLowerCase()] as const);

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

function Table({ tokens, own, onRevoked }: TableProps) {
  return (
    <div class="wide-table" tabIndex={0} role="group" aria-label={text.tokens}>
      <table>
        <thead>
          <tr>
            {text.columns.map((title) => (
              <th key={title} scope="col">
                {title}
              </th>
            ))}
            <th scope="col">
              <span class="unseen">{text.revoke}</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {tokens.map((token) => (
            <tr key={token.id} class={isExpired(token) ? "quiet" : undefined}>
              <th scope="row">
                {token.name}
                {token.id === own && ` ${text.you}`}
              </th>
              <td>
                <code>{token.prefix}…</code>
              </td>
              <td>{token.scope}</td>
              <td>{day(token.created_at)}</td>
              <td>{token.last_used_at ? day(token.last_used_at) : text.never}</td>
              <td>{tokenStatus(token)}</td>
              <td>
                {!isExpired(token) && (
                  <ConfirmButton
                    verb={text.revoke}
                    what={token.name}
                    onConfirm={() => revoke(token, onRevoked)}
                  />
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

async function revoke({ id, name }: Token, onRevoked: () => void): Promise<void> {
  try {
    await revokeToken(id);
    showToast({ kind: "note", text: text.revoked(name) });
    onRevoked();
  } catch (error) {
    showError(error);
  }
}
