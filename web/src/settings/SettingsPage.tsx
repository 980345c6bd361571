/** The settings page: the signed-in principal, and for admins all tokens; the sign-in page. */

import { readPrincipal, signOut, signIn } from "../api/client";
import type { Principal } from "../api/types";
import { useFetched } from "../store/fetch";
import { useListener } from "../store/polling";
import { showFailure } from "../store/toasts";
import { Card, Page } from "../ui/Page";
import { Tokens, day } from "./Tokens";
import { text } from "./text";
import { useState } from "preact/hooks";
import { useSubmit } from "../ui/forms";
import "./settings.css";

export function SettingsPage() {
  const { value, error } = useFetched(readPrincipal, []);
  return (
    <Page title={text.settings} error={error} loading={!value}>
      {value && (
        <>
          <PrincipalCard principal={value} />
          {value.scope === "admin" && <Tokens own={value.token} />}
        </>
      )}
    </Page>
  );
}

const PORT = globalThis.location?.port || "80";

function PrincipalCard({ principal: { name, scope, expires_at, needed } }: { principal: Principal }) {
  const leave = () => void signOut().then(() => location.reload(), showFailure);
  return (
    <Card
      id="you"
      title={needed ? name : text.thisMachine}
      note={<span class="badge">{scope}</span>}
      actions={needed && <button onClick={leave}>{text.signOut}</button>}
    >
      <p>
        {text.allowed[scope]}
        {expires_at && text.validUntil(day(expires_at))}
      </p>
      {!needed && (
        <p class="quiet">
          {text.localOnly}
          <code>
            ssh -L {PORT}:127.0.0.1:{PORT} HOST
          </code>
          .
        </p>
      )}
    </Card>
  );
}

export function SignInPage() {
  const [token, setToken] = useState("");
  const { busy, error, onSubmit } = useSubmit(async () => {
    await signIn(token.trim());
    location.reload();
  });
  // Another tab may have signed in.
  useListener(
    "focus",
    () =>
      void readPrincipal().then(
        () => location.reload(),
        () => {},
      ),
  );
  return (
    <main>
      <form class="card sign-in" onSubmit={onSubmit}>
        <h1>{text.signIn}</h1>
        <p class="quiet">{text.signInHint}</p>
        <label class="over">
          {text.token}
          <input
            type="password"
            name="token"
            autocomplete="current-password"
            required
            value={token}
            aria-invalid={error ? "true" : undefined}
            aria-describedby={error ? "sign-in-error" : undefined}
            onInput={({ currentTarget }) => setToken(currentTarget.value)}
          />
        </label>
        {error && (
          <p id="sign-in-error" class="wrong-text" role="alert">
            {error}
          </p>
        )}
        <button class="primary" disabled={busy || !token.trim()}>
          {text.signIn}
        </button>
      </form>
    </main>
  );
}
