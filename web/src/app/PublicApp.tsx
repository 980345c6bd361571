/** The frame around shared pages, for people without a token. */

import { Brand, Toasts } from "./App";
import { sharedSlug } from "../api/address";
import { CommonsPage, SharedPage } from "../shares/SharedPage";
import { useLocation } from "../store/router";
import { NotFound } from "../ui/Page";
import { lazy } from "../ui/lazy";
import { text } from "./text";

const SharedTreePage = lazy(async () => (await import("../tree/TreePage")).SharedTreePage);

export function PublicApp() {
  const { route, query } = useLocation();
  return (
    <>
      <header class="top">
        <Brand target="_self" />
        <nav aria-label={text.pages}>
          <a href="/commons" target="_self" aria-current={sharedSlug ? undefined : "page"}>
            {text.commons}
          </a>
        </nav>
        <span class="spring" />
      </header>
      {route.page === "share" && <SharedPage slug={route.slug!} sha={route.sha ?? null} query={query} />}
      {route.page === "share-tree" && (
        <SharedTreePage slug={route.slug!} sha={route.sha ?? null} query={query} />
      )}
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
