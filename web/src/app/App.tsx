/** The frame around every page: navigation, connection, notes. */

import { useEffect } from "preact/hooks";
import { readHealth } from "../api/client";
import { lazy } from "../ui/lazy";
import { loadPrincipal, useRefusal, useSignedOut } from "../store/principal";
import { useFetched } from "../store/fetch";
import { useStore } from "../store/store";
import { type Toast, dismissToast, undoLatest, useToasts } from "../store/toasts";
import { DropTarget, OpenButton } from "../ui/DropTarget";
import { RunsPage } from "../runs/RunsPage";
import { type PageLocation, useLocation } from "../store/router";
import { text } from "./text";
import "./app.css";

const ComparePage = lazy(async () => (await import("../compare/ComparePage")).ComparePage);
const CreaturePage = lazy(async () => (await import("../creature/CreaturePage")).CreaturePage);
const NewRunPage = lazy(async () => (await import("../new-run/NewRunPage")).NewRunPage);
const RunPage = lazy(async () => (await import("../run/RunPage")).RunPage);
const SharesPage = lazy(async () => (await import("../shares/SharesPage")).SharesPage);
const SettingsPage = lazy(async () => (await import("../settings/SettingsPage")).SettingsPage);
const SignInPage = lazy(async () => (await import("../settings/SignInPage")).SignInPage);
const SweepPage = lazy(async () => (await import("../sweeps/SweepPage")).SweepPage);
const WorkersPage = lazy(async () => (await import("../workers/WorkersPage")).WorkersPage);

const TITLES: Record<string, string> = {
  runs: text.runs,
  new: text.newRun,
  compare: text.compare,
  workers: text.workers,
  shares: text.shares,
  settings: text.settings,
  unknown: text.notFound,
};

export function App() {
  const place = useLocation();
  const { page } = place.route;
  const unknown = useSignedOut();
  useEffect(() => void loadPrincipal(), []);
  useEffect(() => {
    const title = unknown ? text.signIn : TITLES[page];
    if (title) document.title = text.title(title);
  }, [page, unknown]);
  return (
    <>
      <header class="top">
        <a class="brand" href="/">
          <svg viewBox="0 0 32 20" aria-hidden="true">
            <path d="M2 11c4-9 8-9 12 0s8 9 12 0c1.3-3 2.5-4.5 4-5" />
          </svg>
          {text.brand}
        </a>
        {!unknown && <Navigation page={page} />}
      </header>
      {unknown ? <SignInPage /> : <Page {...place} />}
      {!unknown && <DropTarget />}
      <Toasts />
    </>
  );
}

/** The navigation of a signed-in user. */
function Navigation({ page }: { page: string }) {
  const refusal = useRefusal();
  const health = useFetched(readHealth, []);
  return (
    <>
      <nav aria-label={text.pages}>
        <a href="/" aria-current={page === "runs" ? "page" : undefined}>
          {text.runs}
        </a>
        <a href="/new" aria-current={page === "new" ? "page" : undefined}>
          {text.newRun}
        </a>
        <a href="/workers" aria-current={page === "workers" ? "page" : undefined}>
          {text.workers}
        </a>
        <a href="/shares" aria-current={page === "shares" ? "page" : undefined}>
          {text.shares}
        </a>
        <a href="/commons" target="_self">
          {text.commons}
        </a>
        <a href="/settings" aria-current={page === "settings" ? "page" : undefined}>
          {text.settings}
        </a>
        {health.value?.help && (
          <a href="/help/" target="_self">
            {text.help}
          </a>
        )}
      </nav>
      <span class="spring" />
      {!refusal && <OpenButton />}
      <Connection />
    </>
  );
}

function Page({ route, query }: PageLocation) {
  switch (route.page) {
    case "runs":
      return <RunsPage query={query} />;
    case "new":
      return <NewRunPage query={query} />;
    case "compare":
      return <ComparePage query={query} />;
    case "workers":
      return <WorkersPage />;
    case "settings":
      return <SettingsPage />;
    case "run":
      return <RunPage key={route.id} id={route.id} query={query} />;
    case "sweep":
      return <SweepPage key={route.id} id={route.id} query={query} />;
    case "creature":
      return <CreaturePage key={route.sha} sha={route.sha} query={query} />;
    case "shares":
      return <SharesPage />;
    default:
      return (
        <main>
          <section class="empty card">
            <h1>{text.noSuchPage}</h1>
            <p>
              {text.noSuchPageAbout} <a href="/">{text.allRuns}</a>
            </p>
          </section>
        </main>
      );
  }
}

const CONNECTIONS = {
  connecting: text.connecting,
  live: text.live,
  lost: text.lost,
};

function Connection() {
  const connection = useStore((state) => state.connection);
  const status = CONNECTIONS[connection];
  return (
    <span class={`connection ${connection}`} role="status" title={status}>
      <span class="dot" aria-hidden="true" />
      <span class={connection === "lost" ? "" : "wide-only"}>{status}</span>
    </span>
  );
}

export function Toasts() {
  const toasts = useToasts();
  useEffect(() => {
    document.addEventListener("keydown", undoLatest);
    return () => document.removeEventListener("keydown", undoLatest);
  }, []);
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
