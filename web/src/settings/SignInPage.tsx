/** In place of every page while the server does not know who asks. */

import { useState } from "preact/hooks";
import { signIn } from "../api/client";
import { messageOf } from "../api/problem";
import "./settings.css";

export function SignInPage() {
  const [token, setToken] = useState("");
  const [error, setError] = useState<string | null>(null);
  const [busy, setBusy] = useState(false);
  const submit = async (event: Event) => {
    event.preventDefault();
    setBusy(true);
    try {
      await signIn(token.trim());
      location.reload();
    } catch (problem) {
      setError(messageOf(problem));
      setBusy(false);
    }
  };
  return (
    <main>
      <form class="card sign-in" onSubmit={submit}>
        <h1>Sign in</h1>
        <p class="quiet">
          This server asks for a token. Whoever runs it can make one for you; the first one was shown when it
          was started.
        </p>
        <label>
          Token
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
          Sign in
        </button>
      </form>
    </main>
  );
}
