/** A page for something that does not exist on the server. */

import type { ComponentChildren } from "preact";
import { isId } from "../store/router";
import { text } from "./text";

interface Props {
  /** Title of the missing thing. */
  what: string;
  /** Message of the server. */
  reason: string;
  /** The id in the address; a malformed one is named instead of the server's message. */
  id?: string;
  children?: ComponentChildren;
}

export function NotFound({ what, reason, id, children }: Props) {
  return (
    <section class="empty card">
      <h1>{what}</h1>
      <p role="alert">{reasonOf(reason, id)}</p>
      {children}
    </section>
  );
}

export const reasonOf = (reason: string, id?: string) =>
  id === undefined || isId(id) ? reason : text.unknownId(id);
