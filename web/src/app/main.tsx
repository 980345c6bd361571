import { render } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../ui/tables.css";
import { isPublicPage } from "../api/address";
import { App } from "./App";
import { connect } from "../store/stream";

const app = document.getElementById("app")!;
if (isPublicPage(location.pathname)) {
  const { PublicApp } = await import("./PublicApp");
  render(<PublicApp />, app);
} else {
  await connect();
  render(<App />, app);
}
