import { render } from "preact";
import "uplot/dist/uPlot.min.css";
import { App } from "./app";
import { connect } from "./live/stream";
import "./styles/base.css";
import "./styles/frame.css";
import "./styles/parts.css";
import "./styles/runs.css";
import "./styles/new-run.css";
import "./styles/run.css";
import "./styles/creature.css";
import "./styles/plot.css";
import "./styles/results.css";
import "./styles/audit.css";

connect();
render(<App />, document.getElementById("app")!);
