/** The sign-in page, shown until there is a valid token. */

import { useState } from "preact/hooks";
import { signIn } from "../api/client";
import { useSubmit } from "../ui/submit";
import { text } from "./text";
import "./settings.css";

export function SignInPage() {
  const [token, setToken] = useState("");
  const { busy, error, onSubmit } = useSubmit(async () => {
    await signIn(token.trim());
    location.reload();
  });
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
