/** Who one is here, and the tokens of all. */

import { signOut } from "../api/client";
import { messageOf } from "../api/problem";
import type { Principal } from "../api/types";
import { usePrincipal } from "../store/principal";
import { showToast } from "../store/toasts";
import { Tokens } from "./Tokens";
import { day } from "./tokenText";
import "./settings.css";

export function SettingsPage() {
  const { value, error } = usePrincipal();
  return (
    <main>
      <header class="page-head">
        <h1>Settings</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!value && !error && <p class="quiet loading">Loading …</p>}
      {value && (
        <div class="settings">
          <PrincipalCard principal={value} />
          {value.scope === "admin" && <Tokens own={value.token} />}
        </div>
      )}
    </main>
  );
}

/** Where this page came from. */
const PORT = globalThis.location?.port || "80";

const SCOPE_TEXT = {
  read: "You may look at everything and change nothing.",
  write: "You may look at everything, and change what you made.",
  admin: "You may do everything, also make tokens for others.",
};

function PrincipalCard({ principal: { name, scope, expires_at, needed } }: { principal: Principal }) {
  const leave = async () => {
    try {
      await signOut();
      location.reload();
    } catch (error) {
      showToast({ kind: "wrong", text: messageOf(error) });
    }
  };
  return (
    <section class="card" aria-labelledby="you-title">
      <header class="card-head">
        <h2 id="you-title">{needed ? name : "This machine"}</h2>
        <span class="badge">{scope}</span>
        <span class="spring" />
        {needed && <button onClick={leave}>Sign out</button>}
      </header>
      <p>
        {SCOPE_TEXT[scope]}
        {expires_at && ` Your token is good until ${day(expires_at)}.`}
      </p>
      {!needed && (
        <p class="quiet">
          The server answers nobody but this machine, and asks for no token. From elsewhere it is reached
          safely through{" "}
          <code>
            ssh -L {PORT}:127.0.0.1:{PORT} HOST
          </code>
          .
        </p>
      )}
    </section>
  );
}
