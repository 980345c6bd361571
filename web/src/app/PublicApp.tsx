/** The frame around shared pages, for people without a token. */

import { Toasts } from "./App";
import { sharedSlug } from "../api/address";
import { CommonsPage } from "../shares/CommonsPage";
import { SharedPage } from "../shares/SharedPage";
import { useLocation } from "../store/router";
import { NotFound } from "../ui/NotFound";
import { text } from "./text";

export function PublicApp() {
  const { route, query } = useLocation();
  return (
    <>
      <header class="top">
        <a class="brand" href="/" target="_self">
          <svg viewBox="0 0 32 20" aria-hidden="true">
            <path d="M2 11c4-9 8-9 12 0s8 9 12 0c1.3-3 2.5-4.5 4-5" />
          </svg>
          {text.brand}
        </a>
        <nav aria-label={text.pages}>
          <a href="/commons" target="_self" aria-current={sharedSlug ? undefined : "page"}>
            {text.commons}
          </a>
        </nav>
        <span class="spring" />
      </header>
      {route.page === "share" && <SharedPage slug={route.slug} sha={route.sha} query={query} />}
      {route.page === "commons" && <CommonsPage />}
      {route.page === "unknown" && (
        <main>
          <NotFound what={text.notShared} reason={text.notSharedAbout} />
        </main>
      )}
      <Toasts />
    </>
  );
}
