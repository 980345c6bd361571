import { render } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../ui/tables.css";
import { isPublicPage } from "../api/address";
import { App } from "./App";
import { routeOf } from "../store/router";
import { connect } from "../store/stream";

const app = document.getElementById("app")!;
const { page, slug } = routeOf(location.pathname);
if (page === "embed") {
  const { EmbedPage } = await import("../shares/EmbedPage");
  render(<EmbedPage slug={slug!} query={new URLSearchParams(location.search)} />, app);
} else if (isPublicPage(location.pathname)) {
  const { PublicApp } = await import("./PublicApp");
  render(<PublicApp />, app);
} else {
  await connect();
  render(<App />, app);
}
