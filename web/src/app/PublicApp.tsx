/** The frame around what strangers may see: they have no runs to go to, and no connection. */

import { Toasts } from "./App";
import { sharedSlug } from "../api/address";
import { CommonsPage } from "../shares/CommonsPage";
import { SharedPage } from "../shares/SharedPage";
import { useLocation } from "../store/router";
import { NotFound } from "../ui/NotFound";

export function PublicApp() {
  const { route, query } = useLocation();
  return (
    <>
      <header class="top">
        <a class="brand" href="/" target="_self">
          <svg viewBox="0 0 32 20" aria-hidden="true">
            <path d="M2 11c4-9 8-9 12 0s8 9 12 0c1.3-3 2.5-4.5 4-5" />
          </svg>
          Microcosmos
        </a>
        <nav aria-label="Pages">
          <a href="/commons" target="_self" aria-current={sharedSlug ? undefined : "page"}>
            Commons
          </a>
        </nav>
        <span class="spring" />
      </header>
      {route.page === "share" && <SharedPage slug={route.slug} sha={route.sha} query={query} />}
      {route.page === "commons" && <CommonsPage />}
      {route.page === "unknown" && (
        <main>
          <NotFound what="Nothing to see here" reason="Nothing was shared at this address." />
        </main>
      )}
      <Toasts />
    </>
  );
}
