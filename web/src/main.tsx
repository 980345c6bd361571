import { render } from "preact";
import "uplot/dist/uPlot.min.css";
import { App } from "./app";
import { connect } from "./live/live";
import "./styles/base.css";
import "./styles/parts.css";
import "./styles/pages.css";

connect();
render(<App />, document.getElementById("app")!);
