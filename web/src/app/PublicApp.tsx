/** The frame around what strangers may see: they have no runs to go to, and no connection. */

import { Toasts } from "./App";
import { share } from "../api/address";
import { CommonsPage } from "../shares/CommonsPage";
import { SharedPage } from "../shares/SharedPage";
import { usePlace } from "../store/router";
import { NotThere } from "../ui/NotFound";

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
