/** The tokens of all: made, shown once, revoked. Only admins come here. */

import { useState } from "preact/hooks";
import { createToken, readTokens, revokeToken } from "../api/client";
import { messageOf } from "../api/problem";
import type { Token, CreatedToken, TokenScope } from "../api/types";
import { useFetched } from "../store/fetch";
import { showToast } from "../store/toasts";
import { ConfirmButton } from "../ui/ConfirmButton";
import { Select } from "../ui/Select";
import { copyText } from "../ui/clipboard";
import { TERMS, day, endOf, isExpired, tokenStatus } from "./tokenText";

export function Tokens({ own }: { own: string | null }) {
  const [turn, setTurn] = useState(0);
  const [made, setMade] = useState<CreatedToken | null>(null);
  const { value, error } = useFetched(readTokens, [turn]);
  const again = () => setTurn((count) => count + 1);
  return (
    <section class="card" aria-labelledby="tokens-title">
      <h2 id="tokens-title">Tokens</h2>
      <NewToken
        onMade={(token) => {
          setMade(token);
          again();
        }}
      />
      {made && <Secret made={made} onDone={() => setMade(null)} />}
      {error && <p class="banner wrong">{error}</p>}
      {value?.length === 0 && <p class="quiet">There are none yet.</p>}
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
        Whose it is
        <input
          value={name}
          required
          maxLength={64}
          autocomplete="off"
          placeholder="alice, laptop"
          onInput={({ currentTarget }) => setName(currentTarget.value)}
        />
      </label>
      <Select title="May" choices={SCOPES} value={scope} onChange={(name) => setScope(name as TokenScope)} />
      <Select title="Good for" choices={LIFETIMES} value={days} onChange={setDays} />
      <button class="primary" disabled={!name.trim()}>
        Make a token
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
  ["read", "look (read)"],
  ["write", "look and make (write)"],
  ["admin", "everything (admin)"],
] as const;
const LIFETIMES = TERMS.map(([title, days]) => [String(days), title.toLowerCase()] as const);

/** The only time that it can be read. */
function Secret({ made, onDone }: { made: CreatedToken; onDone: () => void }) {
  return (
    <div class="banner secret" role="status">
      <p>
        The token of <strong>{made.name}</strong>. It is shown only now: keep it where passwords are kept.
      </p>
      <code tabIndex={0}>{made.secret}</code>
      <span class="actions">
        <button onClick={() => copyText(made.secret, "Token copied.")}>Copy</button>
        <button class="plain" onClick={onDone}>
          Done
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
    <div class="wide-table" tabIndex={0} role="group" aria-label="Tokens">
      <table>
        <thead>
          <tr>
            {["Name", "Begins", "May", "Made", "Last used", "Good"].map((title) => (
              <th key={title} scope="col">
                {title}
              </th>
            ))}
            <th scope="col">
              <span class="unseen">Revoke</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {tokens.map((token) => (
            <tr key={token.id} class={isExpired(token) ? "quiet" : undefined}>
              <th scope="row">
                {token.name}
                {token.id === own && " (you)"}
              </th>
              <td>
                <code>{token.beginning}…</code>
              </td>
              <td>{token.scope}</td>
              <td>{day(token.created_at)}</td>
              <td>{token.last_used_at ? day(token.last_used_at) : "Never"}</td>
              <td>{tokenStatus(token)}</td>
              <td>
                {!isExpired(token) && (
                  <ConfirmButton verb="Revoke" what={token.name} onConfirm={() => revoke(token, onRevoked)} />
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
    showToast({ kind: "note", text: `The token of ${name} is revoked.` });
    onRevoked();
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
  }
}
