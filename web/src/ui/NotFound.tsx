/** In place of a page about something that the server does not have. */

interface Props {
  /** What the page would have been about. */
  what: string;
  /** What the server says. */
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
