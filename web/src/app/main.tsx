import { render } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../ui/tables.css";
import { isOpen } from "../api/address";
import { App } from "./App";
import { connect } from "../store/stream";

const app = document.getElementById("app")!;
if (isOpen(location.pathname)) {
  const { Open } = await import("./PublicApp");
  render(<Open />, app);
} else {
  await connect();
  render(<App />, app);
}
