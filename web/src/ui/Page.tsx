/** Parts of every page: frame, cards, notes for empty lists, progress bars. */

import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { isId } from "../store/router";
import { text } from "./text";

interface PageProps {
  /** The heading; pages with a header of their own leave it out. */
  title?: ComponentChildren;
  actions?: ComponentChildren;
  /** Links to the pages above this one. */
  crumbs?: (readonly [href: string, name: string])[];
  error?: string | null;
  loading?: boolean;
  children?: ComponentChildren;
}

export function Page({ title, actions, crumbs, error, loading, children }: PageProps) {
  return (
    <main>
      {crumbs && (
        <nav class="crumbs small" aria-label={text.breadcrumbs}>
          {crumbs.map(([href, name]) => (
            <a key={href} href={href}>
              {name}
            </a>
          ))}
        </nav>
      )}
      {title && (
        <header class="page-head">
          <h1>{title}</h1>
          {actions}
        </header>
      )}
      {error && <p class="banner wrong">{error}</p>}
      {loading && !error && <Loading />}
      {children}
    </main>
  );
}

export const Loading = () => <p class="quiet loading">{text.loading}</p>;

/** Name the browser's tab after the page; null keeps the name. */
export function useTitle(title: string | null): void {
  useEffect(() => {
    if (title) document.title = text.pageTitle(title);
  }, [title]);
}

interface CardProps {
  /** Id of the section; links lead to it. */
  id: string;
  title: ComponentChildren;
  kind?: string;
  note?: ComponentChildren;
  actions?: ComponentChildren;
  children?: ComponentChildren;
}

export function Card({ id, title, kind = "", note, actions, children }: CardProps) {
  const heading = <h2 id={`${id}-title`}>{title}</h2>;
  return (
    <section class={`card ${kind}`} id={id} aria-labelledby={`${id}-title`} tabIndex={-1}>
      {note || actions ? (
        <div class="card-head">
          {heading}
          {note && <span class="quiet small">{note}</span>}
          <span class="spring" />
          {actions}
        </div>
      ) : (
        heading
      )}
      {children}
    </section>
  );
}

interface EmptyProps {
  title: string;
  hint: ComponentChildren;
  children?: ComponentChildren;
}

/** A note in place of a list without entries. */
export function Empty({ title, hint, children }: EmptyProps) {
  return (
    <section class="empty card">
      <h2>{title}</h2>
      <p>{hint}</p>
      {children}
    </section>
  );
}

interface NotFoundProps {
  what: string;
  reason: string;
  /** The id in the address; a malformed one is named instead of the server's message. */
  id?: string;
  children?: ComponentChildren;
}

/** A page for something that does not exist on the server. */
export function NotFound({ what, reason, id, children }: NotFoundProps) {
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

interface ProgressProps {
  label: string;
  /** From 0 to 1. */
  share: number;
  /** CSS class: the status of the run or sweep. */
  kind: string;
}

export function Progress({ label, share, kind }: ProgressProps) {
  const percentage = Math.round(1000 * share) / 10;
  return (
    <div
      class={`progress ${kind}`}
      role="progressbar"
      aria-label={label}
      aria-valuenow={percentage}
      aria-valuemin={0}
      aria-valuemax={100}
    >
      <div style={{ width: `${percentage}%` }} />
    </div>
  );
}
