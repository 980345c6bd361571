import { render } from "preact";
import "uplot/dist/uPlot.min.css";
import { isOpen } from "./api/place";
import { App } from "./app";
import { connect } from "./live/stream";
import "./styles/base.css";
import "./styles/frame.css";
import "./styles/parts.css";
import "./styles/runs.css";
import "./styles/new-run.css";
import "./styles/run.css";
import "./styles/creature.css";
import "./styles/watching.css";
import "./styles/plot.css";
import "./styles/results.css";
import "./styles/audit.css";
import "./styles/archive.css";
import "./styles/guide.css";
import "./styles/run-page.css";
import "./styles/lists.css";
import "./styles/shares.css";
import "./styles/settings.css";
import "./styles/sweeps.css";

const app = document.getElementById("app")!;
if (isOpen(location.pathname)) {
  const { Open } = await import("./open");
  render(<Open />, app);
} else {
  await connect();
  render(<App />, app);
}
