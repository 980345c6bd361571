/** The settings page: the signed-in principal, and for admins all tokens. */

import { signOut } from "../api/client";
import type { Principal } from "../api/types";
import { usePrincipal } from "../store/principal";
import { showFailure } from "../store/toasts";
import { Card, Page } from "../ui/Page";
import { Tokens } from "./Tokens";
import { day } from "./tokenText";
import { text } from "./text";
import "./settings.css";

export function SettingsPage() {
  const { value, error } = usePrincipal();
  return (
    <Page title={text.settings} error={error} loading={!value && text.loading}>
      {value && (
        <div class="settings">
          <PrincipalCard principal={value} />
          {value.scope === "admin" && <Tokens own={value.token} />}
        </div>
      )}
    </Page>
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
  const leave = () => void signOut().then(() => location.reload(), showFailure);
  const head = (
    <>
      <span class="badge">{scope}</span>
      <span class="spring" />
      {needed && <button onClick={leave}>{text.signOut}</button>}
    </>
  );
  return (
    <Card id="you" title={needed ? name : text.thisMachine} head={head}>
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
    </Card>
  );
}
