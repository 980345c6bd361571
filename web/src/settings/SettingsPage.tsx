/** The settings page: the signed-in principal, and for admins all tokens. */

import { readPrincipal, signOut } from "../api/client";
import type { Principal } from "../api/types";
import { useFetched } from "../store/fetch";
import { showFailure } from "../store/toasts";
import { Card, Page } from "../ui/Page";
import { Tokens, day } from "./Tokens";
import { text } from "./text";
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
