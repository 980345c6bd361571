/** The frame around every page: navigation, connection, notes. */

import type { FunctionComponent } from "preact";
import { useEffect, useState } from "preact/hooks";
import { readHealth } from "../api/client";
import { lazy } from "../ui/lazy";
import { loadPrincipal, useRefusal, useSignedOut } from "../store/principal";
import { useFetched } from "../store/fetch";
import { useStore } from "../store/store";
import { useListener } from "../store/polling";
import { type Toast, dismissToast, undoLatest } from "../store/toasts";
import { DropTarget, OpenButton } from "../ui/DropTarget";
import { NotFound, useTitle } from "../ui/Page";
import { type PageLocation, useLocation, navigate } from "../store/router";
import { text } from "./text";
import "./app.css";
import { TEXT_FIELDS } from "../ui/forms";

const PAGES: Record<string, FunctionComponent<{ id: string; query: URLSearchParams }>> = {
  runs: lazy(async () => (await import("../runs/RunsPage")).RunsPage),
  new: lazy(async () => (await import("../new-run/NewRunPage")).NewRunPage),
  compare: lazy(async () => (await import("../compare/ComparePage")).ComparePage),
  workers: lazy(async () => (await import("../workers/WorkersPage")).WorkersPage),
  shares: lazy(async () => (await import("../shares/SharesPage")).SharesPage),
  import: lazy(async () => (await import("../shares/ImportPage")).ImportPage),
  settings: lazy(async () => (await import("../settings/SettingsPage")).SettingsPage),
  run: lazy(async () => (await import("../run/RunPage")).RunPage),
  sweep: lazy(async () => (await import("../sweeps/SweepPage")).SweepPage),
  creature: lazy(async () => (await import("../creature/CreaturePage")).CreaturePage),
  "run-tree": lazy(async () => (await import("../tree/TreePage")).RunTreePage),
  "creature-tree": lazy(async () => (await import("../tree/TreePage")).CreatureTreePage),
};
const Shortcuts = lazy(async () => (await import("./shortcuts/Shortcuts")).Shortcuts, null);
const SignInPage = lazy(async () => (await import("../settings/SettingsPage")).SignInPage);

export function App() {
  const location = useLocation();
  const { page } = location.route;
  const signedOut = useSignedOut();
  const [shortcuts, showShortcuts] = useState(false);
  usePageKeys(() => showShortcuts((shown) => !shown));
  useEffect(() => void loadPrincipal(), []);
  useTitle(signedOut ? text.signIn : ((text.titles as Record<string, string>)[page] ?? null));
  return (
    <>
      <header class="top">
        <Brand />
        {!signedOut && <Navigation page={page} onShortcuts={() => showShortcuts(true)} />}
      </header>
      {signedOut ? <SignInPage /> : <RoutedPage {...location} />}
      {!signedOut && <DropTarget />}
      {shortcuts && <Shortcuts onClose={() => showShortcuts(false)} />}
      <Toasts />
    </>
  );
}

/** The name of the product; on public pages it leaves them. */
export function Brand({ target }: { target?: string }) {
  return (
    <a class="brand" href="/" target={target}>
      <svg viewBox="0 0 32 20" aria-hidden="true">
        <path d="M2 11c4-9 8-9 12 0s8 9 12 0c1.3-3 2.5-4.5 4-5" />
      </svg>
      {text.brand}
    </a>
  );
}

/** Links of the navigation; a link without a page leaves the application. */
const LINKS: [href: string, name: string, page: string | null][] = [
  ["/", text.titles.runs, "runs"],
  ["/new", text.titles.new, "new"],
  ["/workers", text.titles.workers, "workers"],
  ["/shares", text.titles.shares, "shares"],
  ["/commons", text.commons, null],
  ["/settings", text.titles.settings, "settings"],
];

function Navigation({ page, onShortcuts }: { page: string; onShortcuts: () => void }) {
  const refusal = useRefusal();
  const health = useFetched(readHealth, []);
  const chapter = (text.chapters as Record<string, string>)[page] ?? "";
  const help: (typeof LINKS)[0] = [`/help/${chapter}`, text.help, null];
  const links = health.value?.help ? [...LINKS, help] : LINKS;
  return (
    <>
      <nav aria-label={text.pages}>
        {links.map(([href, name, linkedPage]) => (
          <a
            key={name}
            href={href}
            target={linkedPage ? undefined : "_self"}
            aria-current={linkedPage === page ? "page" : undefined}
          >
            {name}
          </a>
        ))}
      </nav>
      <span class="spring" />
      {!refusal && <OpenButton />}
      <button
        class="plain wide-only"
        title={text.shortcutsKey}
        aria-label={text.shortcutsKey}
        onClick={onShortcuts}
      >
        ?
      </button>
      <Connection />
    </>
  );
}

function RoutedPage({ route: { page, id = "" }, query }: PageLocation) {
  const Shown = PAGES[page];
  if (Shown) return <Shown key={`${page} ${id}`} {...{ id, query }} />;
  return (
    <main>
      <NotFound what={text.noSuchPage} reason={text.noSuchPageAbout}>
        <a href="/">{text.allRuns}</a>
      </NotFound>
    </main>
  );
}

function Connection() {
  const connection = useStore((state) => state.connection);
  const status = text.connections[connection];
  return (
    <span class={`connection ${connection}`} role="status" title={status}>
      <span class="dot" aria-hidden="true" />
      <span class={connection === "lost" ? "" : "wide-only"}>{status}</span>
    </span>
  );
}

export function Toasts() {
  const toasts = useStore((state) => state.toasts);
  useListener("keydown", undoLatest);
  return (
    <div class="toasts" role="status" aria-live="polite">
      {toasts.map((toast) => (
        <ToastNote key={toast.id} {...toast} />
      ))}
    </div>
  );
}

function ToastNote({ id, text: message, kind, action }: Toast) {
  return (
    <div class={`toast ${kind}`}>
      <span>{message}</span>
      {action ? (
        <button onClick={action.run} aria-keyshortcuts="Control+Z" title="Ctrl + Z">
          {action.label}
        </button>
      ) : (
        <button class="plain" aria-label={text.dismiss} onClick={() => dismissToast(id)}>
          ✕
        </button>
      )}
    </div>
  );
}

function usePageKeys(toggleShortcuts: () => void): void {
  const actions: Record<string, () => void> = {
    "?": toggleShortcuts,
    "/": () => document.querySelector<HTMLInputElement>("main input[type=search]")?.focus(),
    n: () => navigate("/new"),
  };
  useListener("keydown", (event: KeyboardEvent) => {
    const target = event.target as Element;
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (target.closest?.(TEXT_FIELDS) || (target.closest?.("dialog") && event.key !== "?")) return;
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
