/** The frame around what strangers may see: they have no runs to go to, and no connection. */

import { Toasts } from "./app";
import { share } from "./api/place";
import { CommonsPage } from "./pages/Commons";
import { SharedPage } from "./pages/Shared";
import { usePlace } from "./router";
import { NotThere } from "./view/NotThere";

export function Open() {
  const { route, query } = usePlace();
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
          <a href="/commons" target="_self" aria-current={share ? undefined : "page"}>
            Commons
          </a>
        </nav>
        <span class="spring" />
      </header>
      {route.page === "share" && <SharedPage slug={route.slug} sha={route.sha} query={query} />}
      {route.page === "commons" && <CommonsPage />}
      {route.page === "unknown" && (
        <main>
          <NotThere what="Nothing to see here" reason="Nothing was shared at this address." />
        </main>
      )}
      <Toasts />
    </>
  );
}
