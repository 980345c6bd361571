/** A page for something that does not exist on the server. */

interface Props {
  /** Title of the missing thing. */
  what: string;
  /** Message of the server. */
  reason: string;
}

export function NotFound({ what, reason }: Props) {
  return (
    <section class="empty card">
      <h1>{what}</h1>
      <p role="alert">{reason}</p>
    </section>
  );
}
