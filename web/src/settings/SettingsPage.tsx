/** The settings page: the signed-in principal, and for admins all tokens. */

import { signOut } from "../api/client";
import type { Principal } from "../api/types";
import { usePrincipal } from "../store/principal";
import { showError } from "../store/toasts";
import { Tokens } from "./Tokens";
import { day } from "./tokenText";
import { text } from "./text";
import "./settings.css";

export function SettingsPage() {
  const { value, error } = usePrincipal();
  return (
    <main>
      <header class="page-head">
        <h1>{text.settings}</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!value && !error && <p class="quiet loading">{text.loading}</p>}
      {value && (
        <div class="settings">
          <PrincipalCard principal={value} />
          {value.scope === "admin" && <Tokens own={value.token} />}
        </div>
      )}
    </main>
  );
}

/** The port of this page. */
const PORT = globalThis.location?.port || "80";

const SCOPE_TEXT = {
  read: text.scopeRead,
  write: text.scopeWrite,
  admin: text.scopeAdmin,
};

function PrincipalCard({ principal: { name, scope, expires_at, needed } }: { principal: Principal }) {
  const leave = async () => {
    try {
      await signOut();
      location.reload();
    } catch (error) {
      showError(error);
    }
  };
  return (
    <section class="card" aria-labelledby="you-title">
      <header class="card-head">
        <h2 id="you-title">{needed ? name : text.thisMachine}</h2>
        <span class="badge">{scope}</span>
        <span class="spring" />
        {needed && <button onClick={leave}>{text.signOut}</button>}
      </header>
      <p>
        {SCOPE_TEXT[scope]}
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
    </section>
  );
}
